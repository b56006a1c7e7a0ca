// SPDX-License-Identifier: Apache-2.0
#include "elastocal/identifiability/observability.hpp"

#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

TEST(Observability, IndicesByHand) {
  const ObservabilityIndices o = ComputeObservability(Eigen::Vector3d(8, 4, 2), 16);
  EXPECT_NEAR(o.o1, 4.0 / 4.0, 1e-15);  // cube root of 64, over sqrt(16)
  EXPECT_DOUBLE_EQ(o.o2, 0.25);
  EXPECT_DOUBLE_EQ(o.o3, 2.0);
  EXPECT_DOUBLE_EQ(o.o4, 0.5);
  EXPECT_DOUBLE_EQ(o.o5, 8.0 / 7.0);
  const ObservabilityIndices any_order = ComputeObservability(Eigen::Vector3d(4, 2, 8), 16);
  EXPECT_EQ(any_order.o2, o.o2);
  EXPECT_EQ(any_order.o4, o.o4);
}

TEST(Observability, LostRankMakesAllIndicesZero) {
  const ObservabilityIndices o = ComputeObservability(Eigen::Vector3d(8, 4, 0), 16);
  for (double index : {o.o1, o.o2, o.o3, o.o4, o.o5}) EXPECT_EQ(index, 0.0);
  EXPECT_EQ(ComputeObservability(Eigen::VectorXd(), 16).o1, 0.0);
}

TEST(Observability, ManySmallSingularValuesDoNotUnderflow) {
  // Their product is 1e-400.
  EXPECT_NEAR(ComputeObservability(Eigen::VectorXd::Constant(100, 1e-4), 1).o1, 1e-4, 1e-17);
}

TEST(Excitation, OfAFactorWithKnownSingularValues) {
  Eigen::MatrixXd factor = Eigen::Vector4d(8, 4, 2, 1).asDiagonal();
  const Excitation e = AssessExcitation(factor, {0, 1, 2}, 16, 0.2e-3);
  EXPECT_NEAR(e.indices.o1, 1.0, 1e-14);
  EXPECT_NEAR(e.indices.o3, 2.0, 1e-14);
  // Columns that are scaled to unit norm are orthonormal here.
  EXPECT_NEAR(e.condition_all, 1.0, 1e-14);
  EXPECT_NEAR(e.condition_base, 1.0, 1e-14);
  EXPECT_LT((e.parameter_sd - 0.2e-3 * Eigen::Vector3d(1 / 8., 1 / 4., 1 / 2.)).norm(), 1e-17);
}

TEST(Excitation, StandardDeviationsAreThoseOfTheInverse) {
  Random random(1);
  Eigen::MatrixXd factor = random.NormalVector(30 * 6, 1.0).reshaped(30, 6);
  factor.col(2) *= 1e-3;  // units do not matter
  const std::vector<int> base = {0, 2, 3, 5};
  const Eigen::MatrixXd R = factor(Eigen::all, base);
  const Eigen::MatrixXd information = R.transpose() * R;
  const Eigen::VectorXd expected = 0.5 * information.inverse().diagonal().cwiseSqrt();
  const Eigen::VectorXd sd = AssessExcitation(factor, base, 10, 0.5).parameter_sd;
  // The explicit inverse has an error of the squared ratio of the units, 1e6, times 1e-16.
  EXPECT_LT((sd.cwiseQuotient(expected).array() - 1.0).abs().maxCoeff(), 1e-9);
}

TEST(Excitation, DependentColumns) {
  // The third column is the sum of the first two. The fourth is independent of them.
  Eigen::MatrixXd factor(4, 4);
  factor << 1, 0, 1, 0,  //
      0, 1, 1, 0,        //
      0, 0, 0, 2,        //
      0, 0, 0, 0;
  const Excitation all = AssessExcitation(factor, {0, 1, 2, 3}, 4, 0.1);
  EXPECT_TRUE(std::isinf(all.condition_all));
  EXPECT_TRUE(std::isinf(all.condition_base));
  for (int i : {0, 1, 2}) EXPECT_TRUE(std::isinf(all.parameter_sd[i])) << all.parameter_sd[i];
  EXPECT_NEAR(all.parameter_sd[3], 0.05, 1e-15);
  const Excitation some = AssessExcitation(factor, {0, 1, 3}, 4, 0.1);
  EXPECT_TRUE(std::isinf(some.condition_all));
  EXPECT_NEAR(some.condition_base, 1.0, 1e-14);
  EXPECT_LT((some.parameter_sd - Eigen::Vector3d(0.1, 0.1, 0.05)).norm(), 1e-15);
}

TEST(Excitation, AColumnOfZerosIsNotExcited) {
  Eigen::MatrixXd factor = Eigen::MatrixXd::Identity(3, 3);
  factor(1, 1) = 0.0;
  const Excitation e = AssessExcitation(factor, {0, 1, 2}, 1, 0.1);
  EXPECT_TRUE(std::isinf(e.parameter_sd[1]));
  EXPECT_NEAR(e.parameter_sd[0], 0.1, 1e-15);
  EXPECT_TRUE(std::isinf(e.condition_base));
  EXPECT_EQ(e.indices.o1, 0.0);
}

TEST(Excitation, OfTooFewRowsOrNoColumns) {
  const Eigen::MatrixXd factor = Eigen::MatrixXd::Ones(2, 4);
  const Excitation e = AssessExcitation(factor, {0, 1, 2}, 1, 0.1);
  EXPECT_TRUE(std::isinf(e.condition_base));
  EXPECT_TRUE(std::isinf(e.parameter_sd.minCoeff()));
  EXPECT_EQ(e.indices.o1, 0.0);
  EXPECT_EQ(AssessExcitation(factor, {}, 1, 0.1).parameter_sd.size(), 0);
}

TEST(HardlyExcited, NamesParametersThatAreNotToldToADegreeOrFiveMillimetres) {
  const auto parameter = [](ParameterKind kind, ParameterUnit unit) {
    Parameter p;
    p.kind = kind;
    p.unit = unit;
    return p;
  };
  const std::vector<Parameter> parameters = {
      parameter(ParameterKind::kTheta, ParameterUnit::kRadian),
      parameter(ParameterKind::kTorsion, ParameterUnit::kRadianPerNewtonMetre),
      parameter(ParameterKind::kTorsion, ParameterUnit::kRadianPerNewtonMetre),
      parameter(ParameterKind::kR, ParameterUnit::kMetre),
      parameter(ParameterKind::kTheta, ParameterUnit::kRadian)};
  Excitation excitation;
  excitation.parameters = {0, 3, 4};
  excitation.parameter_sd = Eigen::Vector3d(1e-3, 6e-3, 1e-3);
  EXPECT_EQ(HardlyExcited(parameters, excitation), std::vector<int>{3});
}

}  // namespace
}  // namespace elastocal
