// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/leg_stiffness.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/standing_biped.hpp"

namespace elastocal {
namespace {

// Nothing else gives way, so that the lumped compliance is the leg's own.
TEST(AssessLegs, TheStiffnessIsThatOfItsCompliancesInTheMeanPosture) {
  const StandingBiped robot;
  Recording recording = robot.Empty({{.name = "left", .chains = {}, .support = {robot.left}}}, 3);
  recording.q.col(0) = Eigen::Vector3d(0.1, 0.2, 0.6);
  CalibrationResult result;
  result.model = robot.model;
  result.delta.setZero(robot.model.parameter_count());
  for (int i = 0; i < robot.model.parameter_count(); ++i) {
    const Parameter& parameter = robot.model.parameters[i];
    if (parameter.kind == ParameterKind::kLegForce) result.delta[i] = 1e-6 * (1 + parameter.axis);
    if (parameter.kind == ParameterKind::kLegMoment) result.delta[i] = 1e-5 * (1 + parameter.axis);
  }
  result.placement.footings = {{0, 0, {0, 2}}};
  // The compliance along x is known to a tenth, the one along y hardly. Nothing else is uncertain
  // except the loads, which are known to 5 % because no torque was measured.
  const auto find = [&](const char* name) {
    return FindParameter(robot.model.parameters, robot.model.legs[0].name + name);
  };
  result.posterior.parameters = {find(".compliance_x"), find(".compliance_y")};
  result.posterior.covariance = Eigen::Vector2d(1e-14, 4e-12).asDiagonal();
  result.interval_factor = 2.0;
  const std::vector<LegStiffness> legs = AssessLegs(result, recording);
  ASSERT_EQ(legs.size(), 1u);  // the right leg never stood
  EXPECT_EQ(legs[0].leg, "left");
  EXPECT_DOUBLE_EQ(legs[0].q[0], 0.35);
  ASSERT_EQ(legs[0].posture.size(), robot.model.legs[0].joints.size());
  Vector6d expected;
  expected << 1e6, 1e6 / 2, 1e6 / 3, 1e5, 1e5 / 2, 1e5 / 3;
  EXPECT_EQ(legs[0].load_share, 0.05);
  const double half = 2.0 * std::hypot(1e-7, 0.05 * 1e-6);
  EXPECT_NEAR(legs[0].low[0], 1.0 / (1e-6 + half), 1e-3);
  EXPECT_NEAR(legs[0].high[0], 1.0 / (1e-6 - half), 1e-3);
  EXPECT_TRUE(legs[0].known(0));
  EXPECT_NEAR(legs[0].low[1], 1.0 / (2e-6 + 2.0 * std::hypot(2e-6, 0.05 * 2e-6)), 1e-3);
  EXPECT_FALSE(legs[0].known(1));
  EXPECT_LT((legs[0].stiffness - expected).cwiseQuotient(expected).cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace elastocal
