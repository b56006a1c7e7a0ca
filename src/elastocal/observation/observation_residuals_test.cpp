// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/observation_residuals.hpp"

#include <algorithm>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "elastocal/observation/observed_study.hpp"
#include "tests/instrumented_biped.hpp"

namespace elastocal {
namespace {

/// Largest error of the derivatives against central differences, relative to the norm of its
/// column.
double LargestDifference(ObservationResiduals& residuals) {
  const Eigen::VectorXd x = residuals.Start();
  residuals.Evaluate(x, true);
  std::vector<LeastSquaresProblem::RowMajorMatrix> jacobians;
  for (std::size_t b = 0; b < residuals.residual_blocks.size(); ++b) {
    jacobians.push_back(residuals.Jacobian(static_cast<int>(b)));
  }
  std::vector<Eigen::Index> first = {0};
  for (int size : residuals.parameter_blocks) first.push_back(first.back() + size);
  // Values are about 1 to 100: the step's square leaves 1e-8 of truncation, and rounding is 1e-9.
  const double step = 1e-4;
  double largest = 0.0;
  for (std::size_t block = 0; block + 1 < first.size(); ++block) {
    for (Eigen::Index i = first[block]; i < first[block + 1]; ++i) {
      Eigen::VectorXd forward = x;
      Eigen::VectorXd backward = x;
      forward[i] += step;
      backward[i] -= step;
      residuals.Evaluate(forward, false);
      std::vector<Eigen::VectorXd> ahead;
      for (std::size_t b = 0; b < jacobians.size(); ++b) {
        ahead.push_back(residuals.Residual(static_cast<int>(b)));
      }
      residuals.Evaluate(backward, false);
      for (std::size_t b = 0; b < jacobians.size(); ++b) {
        const Eigen::VectorXd difference =
            (ahead[b] - residuals.Residual(static_cast<int>(b))) / (2.0 * step);
        Eigen::Index column = 0;
        bool depends = false;
        for (int of : residuals.residual_blocks[b].parameter_blocks) {
          if (of == static_cast<int>(block)) {
            const Eigen::VectorXd own = jacobians[b].col(column + i - first[block]);
            largest = std::max(largest, (own - difference).norm() / (1.0 + own.norm()));
            depends = true;
          }
          column += residuals.parameter_blocks[static_cast<std::size_t>(of)];
        }
        if (!depends) largest = std::max(largest, difference.norm());
        if (column != jacobians[b].cols()) return 1e300;
      }
    }
  }
  return largest;
}

void CheckDerivatives(const InstrumentedBiped& biped, std::uint64_t seed) {
  Random random(seed);
  const ObservedValues truth = RandomTruth(biped.model, biped.touches() ? 2 : 0, random);
  const Observations all = biped.Observe(truth, 2, 12, random);
  std::set<std::string> kinds;
  for (const Observation& of : all.all) kinds.insert(biped.model.instrument(of.instrument).kind());
  EXPECT_EQ(kinds.size(), biped.touches() ? 7u : 6u);
  // The values do not fit the observations. Loads are constants of the problem and bend the robot.
  const ObservedValues at = RandomTruth(biped.model, biped.touches() ? 2 : 0, random);
  const std::vector<JointLoads> loads = ObservedLoads(biped.model, all, at.robot);
  const Spread spread = FirstSpread(biped.model.setup.sources);
  std::vector<double> weights(all.all.size(), 1.0);
  weights[0] = 0.5;
  weights[1] = 0.0;
  ObservationResiduals residuals(biped.model, all, loads, spread, weights, {}, at);
  EXPECT_LT(LargestDifference(residuals), 1e-7) << "seed " << seed;
}

TEST(ObservationResiduals, DerivativesOfAllKindsAgreeWithDifferencesOnFeet) {
  const InstrumentedBiped biped(InstrumentedBiped::kOnFeet);
  for (std::uint64_t seed : {1u, 2u, 3u}) CheckDerivatives(biped, seed);
}

TEST(ObservationResiduals, DerivativesOfAllKindsAgreeWithDifferencesWithAFixedRoot) {
  const InstrumentedBiped biped(InstrumentedBiped::kFixed);
  for (std::uint64_t seed : {4u, 5u}) CheckDerivatives(biped, seed);
}

/// Checks corrections of joints and, with a fixed root, those of its suspension and of loads.
void CheckCorrections(const InstrumentedBiped& biped, std::size_t least, std::uint64_t seed) {
  Random random(seed);
  const ObservedValues truth = RandomTruth(biped.model, biped.touches() ? 2 : 0, random);
  Observations all = biped.Observe(truth, 2, 12, random);
  all.approach.setOnes(all.q.rows(), all.q.cols());
  const ObservedRobot wide = WithCorrections(
      biped.model, {}, all, ObservableCorrections(biped.model.robot.tree, biped.model.setup));
  ObservedValues at = ValuesOfWide(wide, biped.model, truth);
  std::size_t corrections = 0;
  for (int i = 0; i < wide.robot.parameter_count(); ++i) {
    const Parameter& parameter = wide.robot.parameters[static_cast<std::size_t>(i)];
    if (parameter.kind != ParameterKind::kCorrection) continue;
    at.robot[i] = random.Normal(0.2 * parameter.typical);
    ++corrections;
  }
  EXPECT_GE(corrections, least);
  const std::vector<JointLoads> loads = ObservedLoads(wide, all, at.robot);
  const Spread spread = FirstSpread(wide.setup.sources);
  const std::vector<double> weights(all.all.size(), 1.0);
  ObservationResiduals residuals(wide, all, loads, spread, weights, {}, at);
  EXPECT_LT(LargestDifference(residuals), 1e-7) << "seed " << seed;
}

TEST(ObservationResiduals, DerivativesByCorrectionsAgreeWithDifferences) {
  const InstrumentedBiped fixed(InstrumentedBiped::kFixed), standing(InstrumentedBiped::kOnFeet);
  CheckCorrections(fixed, 100, 6);
  CheckCorrections(standing, 100, 7);
}

TEST(ObservationResiduals, AreThoseOfTheNominalRobotByHand) {
  const ObservedRobot model = MakeTouchingBiped();
  Random random(4);
  Observations touches;
  touches.files = {"f"};
  touches.postures = {{0, 2}, {0, 3}};
  touches.all = {{0, 0, {}, {}}, {1, 1, {}, {}}};
  touches.q.resize(2, model.robot.tree.coordinate_count());
  for (int i = 0; i < 2; ++i) touches.q.row(i) = TouchingPosture(model, random);
  const ObservedValues nominal = NominalValues(model, touches);
  const Eigen::VectorXd left = LeftOf(model, touches, nominal)[1];
  // With equal feet, the root stands in the middle of the poses that the two legs give by the links
  // of the URDF.
  const ObservationSetup& setup = model.setup;
  const std::vector<Transform> T =
      LinkTransforms(model.robot.tree, Eigen::VectorXd(touches.q.row(1)));
  Eigen::Vector3d height = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation[2];
  for (std::size_t f = 0; f < 2; ++f) {
    const Transform root = setup.feet[f].T_floor_foot * T[setup.feet[f].link].inverse();
    height += 0.5 * root.translation();
    rotation[f] = Eigen::Quaterniond(root.linear());
  }
  Transform root = Transform::Identity();
  root.linear() = rotation[0].slerp(0.5, rotation[1]).toRotationMatrix();
  root.translation() = height;
  const Transform hand = root * T[setup.plates[1].link];
  const Eigen::Vector3d pivot =
      nominal.quantities[model.instrument(1).quantities[1]].origin.translation();
  EXPECT_NEAR(left[0], (hand * setup.plates[1].face.p_link_face - pivot).z(), 1e-12);
  const Eigen::Vector3d up = (hand.linear() * setup.plates[1].face.R_link_face).transpose().col(2);
  EXPECT_NEAR(left[1], std::atan2(up.y(), up.z()), 1e-12);
  EXPECT_NEAR(left[2], -std::asin(up.x()), 1e-12);
}

TEST(ObservationResiduals, ParametersInCommonHaveOneUnknown) {
  const ObservedRobot model = MakeTouchingBiped();
  const auto unknown = [&](const char* name) {
    return model.unknown[FindParameter(model.robot.parameters, name)];
  };
  EXPECT_EQ(unknown("left_3.compliance_z"), unknown("right_3.compliance_z"));
  EXPECT_NE(unknown("left_3.theta"), unknown("right_3.theta"));
  EXPECT_EQ(unknown("waist.T0.r"), -1);
  Observations left_only;
  left_only.all = {{0, 0, {}, {}}};
  ObservedRobot reduced = model;
  KeepObservedUnknowns(left_only, reduced);
  EXPECT_EQ(reduced.unknown[FindParameter(model.robot.parameters, "arm_right_2.theta")], -1);
  EXPECT_GE(reduced.unknown[FindParameter(model.robot.parameters, "arm_left_2.theta")], 0);
  EXPECT_EQ(reduced.unknown_count,
            *std::max_element(reduced.unknown.begin(), reduced.unknown.end()) + 1);
}

}  // namespace
}  // namespace elastocal
