// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/robot_tree.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "tests/expect_input_error.hpp"
#include "tests/random_robot.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

using Eigen::Vector3d;

// A few roundings of lengths below a metre.
constexpr double kTreeRounding = 1e-15;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(RobotTree, LinkTransformsOfThePlanarArm) {
  const RobotTree tree = PlanarArm();
  // Both joints turn by 90 degrees: the upper arm is along y, and the forearm points back along x.
  const auto T = LinkTransforms(tree, Eigen::Vector2d(M_PI / 2, M_PI / 2));
  ASSERT_EQ(T.size(), 4u);
  EXPECT_EQ(T[0].matrix(), Transform::Identity().matrix());
  EXPECT_LT(T[1].translation().norm(), kTreeRounding);
  EXPECT_LT((T[2].translation() - Vector3d(0, 0.5, 0)).norm(), kTreeRounding);
  EXPECT_LT((T[3].translation() - Vector3d(-0.3, 0.5, 0)).norm(), kTreeRounding);
  EXPECT_LT((T[3].linear().col(0) - Vector3d(-1, 0, 0)).norm(), kTreeRounding);
}

TEST(RobotTree, LinkTransformsOfSlidingAndMimicJoints) {
  const RobotTree tree = RailArm();
  ASSERT_EQ(tree.coordinate_count(), 5);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(5);
  const auto T_zero = LinkTransforms(tree, q);
  q[0] = 0.5;
  q[4] = 0.03;
  const auto T = LinkTransforms(tree, q);
  const int hand = FindLink(tree, "hand_link");
  const Vector3d rail = T[FindLink(tree, "mount")].linear() * Vector3d(1, 1, 0.2).normalized();
  EXPECT_LT((T[hand].translation() - T_zero[hand].translation() - 0.5 * rail).norm(),
            kTreeRounding);
  // In the hand's y, the leader is at 0.03 and the mimic joint at -0.03 + 0.01.
  const auto in_hand = [&](const char* link) {
    return Vector3d(T[hand].inverse() * T[FindLink(tree, link)].translation());
  };
  EXPECT_LT((in_hand("finger_1_link") - Vector3d(0.05, 0.05, 0)).norm(), kTreeRounding);
  EXPECT_LT((in_hand("finger_2_link") - Vector3d(0.05, -0.04, 0)).norm(), kTreeRounding);
}

TEST(RobotTree, JointsToBodyFollowOneBranch) {
  const RobotTree tree = RailArm();
  EXPECT_EQ(JointsToBody(tree, 0), std::vector<int>{});
  EXPECT_EQ(JointsToBody(tree, 5), (std::vector<int>{0, 1, 2, 3, 4}));
  EXPECT_EQ(JointsToBody(tree, 6), (std::vector<int>{0, 1, 2, 3, 5}));
}

TEST(RobotTree, FindsByName) {
  const RobotTree tree = PlanarArm();
  EXPECT_EQ(FindLink(tree, "tip"), 3);
  EXPECT_EQ(FindJoint(tree, "elbow"), 1);
  ExpectInputError([&] { FindLink(tree, "tipp"); }, {"'robot'", "link 'tipp'", "mean 'tip'?"});
  ExpectInputError([&] { FindJoint(tree, "elbo"); }, {"joint 'elbo'", "mean 'elbow'?"});
  ExpectInputError([&] { FindJoint(tree, "tip"); }, {"no movable joint 'tip'"});
}

TEST(RobotTree, SizeIsTwiceTheLongestBranch) {
  EXPECT_DOUBLE_EQ(RobotSize(PlanarArm()), 2.0 * (0.5 + 0.3));
  RobotTree tree = MakeRoot();
  const int link = AddJoint(tree, "slide", 0, Offset(0, 0, 2), {0, 0, 1}, JointType::kPrismatic);
  AddFixedLink(tree, "end", link, Offset(3, 0, 0));
  tree.joints[0].limits = {-4, 1, 0, 0};
  EXPECT_DOUBLE_EQ(RobotSize(tree), 2.0 * (2 + 4 + 3));
}

TEST(RobotTree, RandomPosturesFillTheLimits) {
  RobotTree tree = RailArm();
  tree.joints[1].limits = {0.2, 0.4, 0, 0};
  tree.joints[2].limits = {-kInfinity, kInfinity, 0, 0};
  tree.joints[4].limits = {-kInfinity, kInfinity, 0, 0};
  const Eigen::VectorXd lower = (Eigen::VectorXd(5) << -1, 0.2, -M_PI, -1, -0.5).finished();
  const Eigen::VectorXd upper = (Eigen::VectorXd(5) << 1, 0.4, M_PI, 1, 0.5).finished();
  Random random(1);
  Eigen::MatrixXd q(5, 2000);
  for (int i = 0; i < q.cols(); ++i) q.col(i) = RandomPosture(tree, random);
  const Eigen::VectorXd smallest = q.rowwise().minCoeff(), largest = q.rowwise().maxCoeff();
  EXPECT_TRUE((smallest.array() >= lower.array()).all()) << smallest;
  EXPECT_TRUE((largest.array() <= upper.array()).all()) << largest;
  // With 2000 numbers, the last 1 % at an end remains empty with probability 0.99^2000 = 2e-9.
  const Eigen::VectorXd margin = 0.01 * (upper - lower);
  EXPECT_TRUE((smallest.array() <= (lower + margin).array()).all()) << smallest;
  EXPECT_TRUE((largest.array() >= (upper - margin).array()).all()) << largest;
}

TEST(RobotTree, PosturesUseOneTurnOfAJointThatCountsTurns) {
  RobotTree tree = RailArm();
  Joint& joint = tree.joints[1];
  ASSERT_EQ(joint.type, JointType::kRevolute);
  const auto range = [&](double lower, double upper) {
    joint.limits = {lower, upper, 0, 0};
    return PostureRange(joint);
  };
  EXPECT_EQ(range(-2.0, 3.0), std::pair(-2.0, 3.0));
  EXPECT_EQ(range(-10.0, 10.0), std::pair(-M_PI, M_PI));
  EXPECT_EQ(range(1.0, 11.0), std::pair(1.0, 1.0 + 2.0 * M_PI));
  EXPECT_EQ(range(-9.0, -1.0), std::pair(-1.0 - 2.0 * M_PI, -1.0));
  EXPECT_EQ(range(-kInfinity, 2.0), std::pair(-M_PI, 2.0));
  joint.limits = {-10.0, 10.0, 0, 0};
  EXPECT_EQ(PostureRange(joint, 0.0, 4.0), std::pair(4.0 - M_PI, 4.0 + M_PI));
  EXPECT_EQ(PostureRange(joint, 0.0, 9.0), std::pair(10.0 - 2.0 * M_PI, 10.0));
  joint.limits = {-1.0, 3.0, 0, 0};
  EXPECT_EQ(PostureRange(joint, 0.25), std::pair(0.0, 2.0));
  // A rail of ten metres keeps its range.
  tree.joints[0].type = JointType::kPrismatic;
  tree.joints[0].limits = {-5.0, 5.0, 0, 0};
  EXPECT_EQ(PostureRange(tree.joints[0]), std::pair(-5.0, 5.0));
}

}  // namespace
}  // namespace elastocal
