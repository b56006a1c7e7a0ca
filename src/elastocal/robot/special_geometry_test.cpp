// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/special_geometry.hpp"

#include <gtest/gtest.h>

#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

using Kind = SpecialGeometry::Kind;
using Joints = std::vector<int>;

// Rounding of positions and directions of order 1.
constexpr double kGeometryRounding = 1e-15;

std::vector<Joints> Found(const RobotTree& tree, Kind kind) {
  std::vector<Joints> joints;
  for (const SpecialGeometry& group : FindSpecialGeometry(tree)) {
    if (group.kind == kind) joints.push_back(group.joints);
  }
  return joints;
}

TEST(SpecialGeometry, TalosLegHasAHipAndTwoParallelPairs) {
  EXPECT_EQ(Found(TalosLeg(), Kind::kSphericalWrist), std::vector<Joints>({{0, 1, 2}}));
  EXPECT_EQ(Found(TalosLeg(), Kind::kParallelAxes), std::vector<Joints>({{2, 3}, {3, 4}}));
}

TEST(SpecialGeometry, AntiparallelAxesCount) {
  RobotTree tree = PlanarArm();
  tree.joints[1].axis = -tree.joints[1].axis;
  EXPECT_EQ(Found(tree, Kind::kParallelAxes), std::vector<Joints>({{0, 1}}));
}

TEST(SpecialGeometry, AWristMeetsAwayFromTheOrigins) {
  RobotTree tree = TalosLeg();
  tree.joints[1].T_parent_child = Offset(0.1, 0, 0);     // moves along the joint's own axis
  tree.joints[2].T_parent_child = Offset(-0.1, 0.2, 0);  // moves back, and then along its own axis
  EXPECT_EQ(Found(tree, Kind::kSphericalWrist), std::vector<Joints>({{0, 1, 2}}));
}

TEST(SpecialGeometry, WithinAMicrometreAndAMicroradian) {
  for (double error : {0.5e-6, 2e-6}) {
    RobotTree wrist = TalosLeg();
    wrist.joints[2].T_parent_child = Offset(0, 0, error);
    EXPECT_EQ(Found(wrist, Kind::kSphericalWrist).empty(), error > 1e-6);
    RobotTree knee = TalosLeg();
    knee.joints[3].T_parent_child = Offset(0, 0, -0.38) * RotX(error);
    EXPECT_EQ(Found(knee, Kind::kParallelAxes).size(), error > 1e-6 ? 1u : 2u);
  }
}

TEST(SpecialGeometry, SlidingJointsAndOtherBranchesDoNotCount) {
  RobotTree tree = PlanarArm();
  tree.joints[1].type = JointType::kPrismatic;
  EXPECT_TRUE(FindSpecialGeometry(tree).empty());
  tree = PlanarArm();
  AddJoint(tree, "second_arm", 0, Offset(0, 1, 0), {0, 0, 1});  // parallel, but beside the others
  EXPECT_EQ(FindSpecialGeometry(tree).size(), 1u);
}

TEST(SpecialGeometry, DeviationOfACorrectedRobot) {
  const RobotTree nominal = TalosLeg();
  RobotTree corrected = nominal;
  corrected.joints[1].T_parent_child = Offset(0, 0.003, 0);
  corrected.joints[4].T_parent_child = Offset(0, 0, -0.325) * RotX(0.3) * RotZ(0.4);
  for (const SpecialGeometry& group : FindSpecialGeometry(nominal)) {
    EXPECT_LT(Deviation(nominal, group), kGeometryRounding);
    const double deviation = Deviation(corrected, group);
    if (group.kind == Kind::kSphericalWrist) {
      // Axis 2 passes axis 1 at a distance of 3 mm. Axis 3, along y, meets both.
      EXPECT_NEAR(deviation, 0.003, kGeometryRounding);
    } else if (group.joints[1] == 4) {
      // The ankle's y axis becomes Rx Rz y = (-sin .4, cos .4 cos .3, cos .4 sin .3).
      EXPECT_NEAR(deviation, std::acos(std::cos(0.4) * std::cos(0.3)), 4 * kGeometryRounding);
    } else {
      EXPECT_LT(deviation, kGeometryRounding);
    }
  }
}

TEST(SpecialGeometry, WhatHoldsNearlyIsFoundApart) {
  RobotTree tree = TalosLeg();
  EXPECT_TRUE(FindNearlySpecialGeometry(tree).empty());
  tree.joints[3].T_parent_child = tree.joints[3].T_parent_child * RotX(2e-3);
  tree.joints[2].T_parent_child = Offset(1e-3, 0, 0) * tree.joints[2].T_parent_child;
  const std::vector<SpecialGeometry> found = FindNearlySpecialGeometry(tree);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].joints, Joints({0, 1, 2}));
  EXPECT_NEAR(Deviation(tree, found[0]), 1e-3, 1e-9);
  EXPECT_EQ(found[1].joints, Joints({2, 3}));
  EXPECT_NEAR(Deviation(tree, found[1]), 2e-3, 1e-9);
  EXPECT_NEAR(AxisDistance(tree, 2, 3), 0.38, 1e-9);  // the thigh
  EXPECT_EQ(Found(tree, Kind::kParallelAxes), std::vector<Joints>({{3, 4}}));
}

}  // namespace
}  // namespace elastocal
