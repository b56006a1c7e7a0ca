// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/sequential.hpp"

#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace elastocal {
namespace {

// One parameter with variance p, about which the data have information a. Its change has variance
// w2.
TEST(Sequential, OneParameterByHand) {
  const double p = 4e-6, a = 5e5, w2 = 9e-6;
  const PriorKnowledge prior{.covariance = Eigen::MatrixXd::Constant(1, 1, p),
                             .change_sd = Eigen::VectorXd::Constant(1, std::sqrt(w2))};
  const Eigen::MatrixXd data = Eigen::MatrixXd::Constant(1, 1, a);
  EXPECT_NEAR(ExpectedInformation(prior, data, SequentialAim::kParameters), std::log(1.0 + a * p),
              1e-12);
  // The uncertainty of the parameter itself hides its change: the variance is 1/a + p.
  EXPECT_NEAR(ExpectedInformation(prior, data, SequentialAim::kChanges),
              std::log(1.0 + w2 / (1.0 / a + p)), 1e-12);
  EXPECT_NEAR(ChangeDeviations(prior, data)[0], std::sqrt(1.0 / a + p), 1e-15);
}

// Data that tell only the sum of two parameters tell no change of the one that is unknown.
TEST(Sequential, TwoParametersByHand) {
  const double p = 1e-6, unknown = 1.0, a = 1e8;
  PriorKnowledge prior;
  prior.covariance = Eigen::Vector2d(p, unknown).asDiagonal();
  prior.change_sd = Eigen::Vector2d(0.01, 0.0);
  const Eigen::Matrix2d data = Eigen::Matrix2d::Constant(a);
  const Eigen::VectorXd sd = ChangeDeviations(prior, data);
  EXPECT_NEAR(sd[0], std::sqrt(1.0 / a + p + unknown), 1e-6);
  EXPECT_TRUE(std::isinf(sd[1]));  // it never changes
}

// Correlated parameters in different units, compared with the formulas that use inverses.
TEST(Sequential, CorrelatedParametersByInverses) {
  const Eigen::Vector3d unit(1e-2, 3.0, 0.2);
  Eigen::Matrix3d correlation, told;
  correlation << 1.0, 0.6, -0.3, 0.6, 1.0, 0.2, -0.3, 0.2, 1.0;
  told << 5.0, 1.0, 2.0, 1.0, 3.0, -1.0, 2.0, -1.0, 4.0;
  const Eigen::Matrix3d covariance = unit.asDiagonal() * correlation * unit.asDiagonal();
  const Eigen::Matrix3d data =
      unit.cwiseInverse().asDiagonal() * told * unit.cwiseInverse().asDiagonal();
  const PriorKnowledge prior{.covariance = covariance, .change_sd = Eigen::Vector3d(0.0, 6.0, 0.1)};

  const double all = std::log((Eigen::Matrix3d::Identity() + covariance * data).determinant());
  EXPECT_NEAR(ExpectedInformation(prior, data, SequentialAim::kParameters), all, 1e-12);

  const Eigen::Matrix3d beside = data - data * (data + covariance.inverse()).inverse() * data;
  const Eigen::Vector3d change = prior.change_sd;
  const Eigen::Matrix3d worth =
      Eigen::Matrix3d::Identity() + change.asDiagonal() * beside * change.asDiagonal();
  EXPECT_NEAR(ExpectedInformation(prior, data, SequentialAim::kChanges),
              std::log(worth.determinant()), 1e-12);

  const Eigen::VectorXd sd = ChangeDeviations(prior, data);
  EXPECT_TRUE(std::isinf(sd[0]));
  for (const int i : {1, 2}) EXPECT_NEAR(sd[i] * std::sqrt(beside(i, i)), 1.0, 1e-12) << i;
}

}  // namespace
}  // namespace elastocal
