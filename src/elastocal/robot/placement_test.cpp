// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/placement.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/random_robot.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

constexpr double kRightAngle = M_PI / 2.0;
// Rounding of lengths of about a metre. If axes are nearly parallel, common normals are longer.
constexpr double kPlacementRounding = 1e-14;

std::vector<AxisRelation> AllRelations() {
  std::vector<AxisRelation> relations = kUsualRelations;
  relations.push_back(AxisRelation::kCoaxial);
  return relations;
}

/// Eq. 1 as it is printed.
Transform Placed(const JointPlacement& p, const Joint& joint, double position) {
  const bool revolute = joint.type == JointType::kRevolute;
  return p.T_parent_pre * RotZ(p.gamma) * TrZ(p.b) * RotY(p.beta) * RotX(p.alpha) * TrX(p.d) *
         RotZ(p.theta + (revolute ? position : 0.0)) * TrZ(p.r + (revolute ? 0.0 : position));
}

/// Two joints 0.4 m apart, whose axes are parallel up to a turn of the second by `angle`.
RobotTree TwoAxes(double angle, double distance = 0.4) {
  RobotTree tree = MakeRoot();
  const int link = AddJoint(tree, "first", 0, Transform::Identity(), {0, 0, 1});
  AddJoint(tree, "second", link, Offset(distance, 0, 0.1), RotX(angle) * Eigen::Vector3d(0, 0, 1));
  return tree;
}

void ExpectConstants(const JointPlacement& p, double alpha, double d, double theta, double r) {
  EXPECT_NEAR(p.alpha, alpha, kPlacementRounding);
  EXPECT_NEAR(p.d, d, kPlacementRounding);
  EXPECT_NEAR(p.theta, theta, kPlacementRounding);
  EXPECT_NEAR(p.r, r, kPlacementRounding);
  EXPECT_NEAR(p.beta, 0.0, kPlacementRounding);
  EXPECT_EQ(p.gamma, 0.0);
  EXPECT_EQ(p.b, 0.0);
}

TEST(Placement, TalosLeg) {
  std::vector<JointPlacement> leg = PlaceJoints(TalosLeg(), {});
  const double h = kRightAngle;
  ExpectConstants(leg[0], h, 0, 0, 0);
  ExpectConstants(leg[1], h, 0, h, 0);
  leg[2].theta = std::abs(leg[2].theta);  // half a turn has two signs
  ExpectConstants(leg[2], h, 0, M_PI, 0);
  ExpectConstants(leg[3], 0, 0.380, 0, 0);
  ExpectConstants(leg[4], 0, 0.325, 0, 0);
  ExpectConstants(leg[5], h, 0, 0, 0);
  for (int k = 0; k < 6; ++k) {
    EXPECT_EQ(leg[k].general, k == 0);
    EXPECT_EQ(leg[k].parallel, k == 3 || k == 4);
  }
  // The general placement has its origin on the hip's axis and its own z at right angles to that.
  EXPECT_LT((leg[0].T_parent_pre.translation() - Eigen::Vector3d(-0.02, 0.085, -0.27105)).norm(),
            kPlacementRounding);
  EXPECT_NEAR(leg[0].T_parent_pre.linear().col(2).z(), 0.0, kPlacementRounding);
}

TEST(Placement, SkewAxes) {
  // The common normal is along x, from the first axis to the second, for either direction of the
  // axes.
  for (double angle : {0.5, -0.5, 2.0}) {
    const std::vector<JointPlacement> arm = PlaceJoints(TwoAxes(angle), {});
    ExpectConstants(arm[1], angle, 0.4, 0, 0);
    // The origin of the first joint's frame is where the normal leaves its axis.
    EXPECT_LT((arm[0].T_parent_pre.translation() - Eigen::Vector3d(0, 0, 0.1)).norm(),
              kPlacementRounding);
  }
}

TEST(Placement, BetaBelowTheToleranceOnly) {
  for (double direction : {0.0, M_PI}) {
    EXPECT_TRUE(PlaceJoints(TwoAxes(direction), {})[1].parallel);
    EXPECT_TRUE(PlaceJoints(TwoAxes(direction + 0.17), {})[1].parallel);
    EXPECT_FALSE(PlaceJoints(TwoAxes(direction + 0.18), {})[1].parallel);
    EXPECT_TRUE(
        PlaceJoints(TwoAxes(direction + 0.18), {.parallel_tolerance_rad = 0.2})[1].parallel);
    EXPECT_FALSE(PlaceJoints(TwoAxes(direction + 0.18), {})[1].general);
  }
}

// The shoulder of a humanoid is 0.25 m beside an upright waist and inclined to it. The axes meet a
// metre below. An error of 10 mrad moves that point by centimetres.
TEST(Placement, BetaWhereTheCommonNormalIsFarAway) {
  const auto place = [](double inclined, double beside) {
    RobotTree tree = MakeRoot();
    const int link = AddJoint(tree, "waist", 0, Transform::Identity(), {0, 0, 1});
    AddJoint(tree, "shoulder", link, Offset(0, beside, 0.3), RotX(inclined).linear().col(2));
    const JointPlacement placement = PlaceJoints(tree, {})[1];
    EXPECT_LT(std::abs(placement.r) + std::abs(placement.d), placement.parallel ? 0.7 : 1.5);
    return placement.parallel;
  };
  EXPECT_TRUE(place(0.2, 0.25));
  EXPECT_TRUE(place(0.45, 0.25));
  EXPECT_FALSE(place(0.45, 0.03));  // the axes meet within 7 cm
  EXPECT_FALSE(place(0.6, 0.25));
  EXPECT_FALSE(place(1.5, 2.0));  // nearly at right angles: the point is far away but hardly moves
}

TEST(Placement, TheSameAxisTwiceIsPlacedGenerally) {
  EXPECT_TRUE(PlaceJoints(TwoAxes(0.0, 0.0), {})[1].general);
  EXPECT_TRUE(PlaceJoints(TwoAxes(M_PI + 1e-3, 0.019), {})[1].general);
  EXPECT_FALSE(PlaceJoints(TwoAxes(0.0, 0.021), {})[1].general);
  EXPECT_FALSE(PlaceJoints(TwoAxes(0.5, 0.0), {})[1].general);
}

// Head and arms of a robot with a lift. An axis is displaced across its distance from the lift.
// This must move only the axis, and not turn all that the lift carries.
TEST(Placement, AnAxisParallelToALiftIsPlacedGenerally) {
  const auto place = [](JointType lift, double inclined) {
    RobotTree tree = MakeRoot();
    const int link = AddJoint(tree, "lift", 0, Offset(-0.2, 0.0, 0.5), {0, 0, 1}, lift);
    AddJoint(tree, "head", link, Offset(0.03, 0.0, 0.6), RotX(inclined).linear().col(2));
    return PlaceJoints(tree, {})[1];
  };
  EXPECT_TRUE(place(JointType::kPrismatic, 0.0).general);
  EXPECT_TRUE(place(JointType::kPrismatic, 0.1).general);
  EXPECT_FALSE(place(JointType::kPrismatic, 1.0).general);
  EXPECT_FALSE(place(JointType::kRevolute, 0.0).general);
}

TEST(Placement, TheFirstJointInTheFileContinuesTheChain) {
  const RobotTree tree = RailArm();
  const std::vector<JointPlacement> placements = PlaceJoints(tree, {});
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    EXPECT_EQ(placements[k].general, k == 0 || tree.joints[k].name == "finger_2");
  }
}

class RandomRobots : public testing::TestWithParam<int> {};

TEST_P(RandomRobots, NominalPlacementsGiveTheUrdfsKinematics) {
  Random random(GetParam());
  const RobotTree tree = RandomRobot(AllRelations(), random);
  const std::vector<JointPlacement> placements = PlaceJoints(tree, {});
  for (int i = 0; i < 10; ++i) {
    const Eigen::VectorXd q = RandomPosture(tree, random);
    const std::vector<Transform> T_root_link = LinkTransforms(tree, q);
    std::vector<Transform> T_root_mdh(tree.body_count(), Transform::Identity());
    for (std::size_t k = 0; k < tree.joints.size(); ++k) {
      const Joint& joint = tree.joints[k];
      T_root_mdh[k + 1] =
          T_root_mdh[joint.parent_body] * Placed(placements[k], joint, JointPosition(joint, q));
      const Transform T_root_child = T_root_mdh[k + 1] * placements[k].T_joint_body;
      EXPECT_LT((T_root_child.matrix() - T_root_link[joint.child_link].matrix()).norm(),
                10 * kPlacementRounding)
          << joint.name;
    }
  }
}

TEST_P(RandomRobots, FramesFollowTheConvention) {
  // z is the joint's axis. The constants of a general placement are zero except alpha. Other
  // placements start from the parent's frame, and need beta only if the axes are parallel.
  Random random(GetParam());
  const RobotTree tree = RandomRobot(AllRelations(), random);
  const std::vector<JointPlacement> placements = PlaceJoints(tree, {});
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    const JointPlacement& p = placements[k];
    const Eigen::Vector3d axis = p.T_joint_body.linear() * tree.joints[k].axis;
    EXPECT_LT((axis - Eigen::Vector3d::UnitZ()).norm(), kPlacementRounding);
    if (p.general) {
      EXPECT_FALSE(p.parallel);
      ExpectConstants(p, kRightAngle, 0, 0, 0);
    } else {
      EXPECT_TRUE(p.T_parent_pre.matrix().isIdentity(0.0));
      EXPECT_EQ(p.gamma, 0.0);
      EXPECT_EQ(p.b, 0.0);
      // Axes that are closer coincide or meet.
      EXPECT_GE(p.d, p.parallel ? 0.02 : -1e-9);
      EXPECT_LE(std::abs(p.beta), p.parallel ? 0.25 * M_PI : 0.0);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomRobots, testing::Range(1, 51));

}  // namespace
}  // namespace elastocal
