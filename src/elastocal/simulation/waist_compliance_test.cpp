// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/waist_compliance.hpp"

#include <gtest/gtest.h>

#include "tests/biped.hpp"

namespace elastocal {
namespace {

/// A robot with straight legs, without springs.
TrueRobot Rigid() {
  const Biped biped = MakeBiped();
  return NominalRobot(biped.tree, biped.markers, FindLegs(biped.tree, biped.chains), {});
}

Eigen::VectorXd Straight(const TrueRobot& robot) {
  return Eigen::VectorXd::Zero(robot.tree.coordinate_count());
}

/// A spring gives way more if weight leans on it (a column about to buckle). The expected values
/// are for a robot without weight, so the tests use one with next to none.
TrueRobot Weightless(TrueRobot robot) {
  for (Link& link : robot.tree.links) link.mass *= 1e-3;
  return robot;
}

TEST(LumpedWaistCompliance, OfAColumnOnASpringInItsFoot) {
  TrueRobot robot = Weightless(Rigid());
  const Vector6d c{{1e-6, 2e-6, 3e-6, 1e-5, 2e-5, 3e-5}};
  robot.foot_compliance[0] = c;
  const WaistCompliance waist = LumpedWaistCompliance(robot, robot.legs[0], Straight(robot));
  // The spring is half-way between ankle and sole. The waist's origin is above and beside it.
  const double h = 0.27 + 0.38 + 0.325 + 0.5 * 0.107;
  const double x = 0.02;
  const double y = -0.085;
  const auto near = [&](double found, double expected) {
    EXPECT_NEAR(found, expected, 2e-3 * std::abs(expected) + 1e-9);
  };
  near(waist.C_foot(0, 0), c[0] + c[4] * h * h + c[5] * y * y);
  near(waist.C_foot(1, 1), c[1] + c[3] * h * h + c[5] * x * x);
  near(waist.C_foot(2, 2), c[2] + c[3] * y * y + c[4] * x * x);
  near(waist.C_foot(3, 3), c[3]);
  near(waist.C_foot(4, 4), c[4]);
  near(waist.C_foot(5, 5), c[5]);
  near(waist.C_foot(0, 4), c[4] * h);
  near(waist.C_foot(1, 3), -c[3] * h);
  near(waist.stiffness[2], 1.0 / waist.C_foot(2, 2));
  EXPECT_LT((waist.C_foot - waist.C_foot.transpose()).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(LumpedWaistCompliance, SpringsOfLinksAddUp) {
  TrueRobot robot = Weightless(Rigid());
  for (int k : robot.legs[1].joints) {
    robot.link_compliance[static_cast<std::size_t>(k)] << 0, 0, 1e-6, 0, 0, 0;
  }
  robot.foot_compliance[1] << 0, 0, 2e-6, 0, 0, 0;
  const WaistCompliance waist = LumpedWaistCompliance(robot, robot.legs[1], Straight(robot));
  EXPECT_NEAR(waist.C_foot(2, 2), 8e-6, 2e-8);
}

TEST(LumpedWaistCompliance, OfAJointSpringIsThatOfItsLever) {
  TrueRobot robot = Weightless(Rigid());
  const int ankle = FindJoint(robot.tree, "left_5");
  robot.compliance[ankle] = 1e-5;
  const WaistCompliance waist = LumpedWaistCompliance(robot, robot.legs[0], Straight(robot));
  const double h = 0.27 + 0.38 + 0.325;
  EXPECT_NEAR(waist.C_foot(0, 0), 1e-5 * h * h, 2e-8);
  EXPECT_NEAR(waist.C_foot(4, 4), 1e-5, 2e-8);
  EXPECT_NEAR(waist.C_foot(3, 3), 0.0, 1e-8);
}

TEST(LumpedWaistCompliance, IsThatOfTheSpringAndNotOfAPendulumOnIt) {
  TrueRobot robot = Rigid();
  robot.foot_compliance[0] << 0, 0, 0, 0, 2e-5, 0;
  const WaistCompliance waist = LumpedWaistCompliance(robot, robot.legs[0], Straight(robot));
  // With its weight, the robot would be softer by m g h, some 450 N.m/rad.
  EXPECT_NEAR(waist.stiffness[4], 5e4, 20.0);
}

}  // namespace
}  // namespace elastocal
