// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/subtree.hpp"

#include <gtest/gtest.h>

#include "tests/random_robot.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

std::vector<std::string> JointNames(const RobotTree& tree) {
  std::vector<std::string> names;
  for (const Joint& joint : tree.joints) names.push_back(joint.name);
  return names;
}

using Names = std::vector<std::string>;

TEST(Subtree, HoldsWhatTheLinkCarries) {
  const RobotTree tree = RailArm();
  const RobotTree arm = Subtree(tree, FindLink(tree, "turret_link"));
  EXPECT_EQ(JointNames(arm), (Names{"arm", "hand", "finger_1", "finger_2"}));
  EXPECT_EQ(arm.links[0].name, "turret_link");
  EXPECT_EQ(arm.coordinate_joint, (std::vector<int>{0, 1, 2}));
  EXPECT_TRUE(arm.joints[3].mimic);
  EXPECT_EQ(arm.joints[3].coordinate, arm.joints[2].coordinate);
}

TEST(Subtree, OfALinkOnAFixedJointStartsAtItsBody) {
  const RobotTree tree = RailArm();
  const RobotTree hand = Subtree(tree, FindLink(tree, "flange"));
  EXPECT_EQ(hand.links[0].name, "arm_link");
  EXPECT_TRUE(hand.links[0].T_body_link.matrix().isIdentity(0.0));
  EXPECT_EQ(JointNames(hand), (Names{"hand", "finger_1", "finger_2"}));
}

TEST(Subtree, OfTheRootIsTheTree) {
  const RobotTree tree = RailArm();
  const RobotTree all = Subtree(tree, FindLink(tree, "mount"));
  EXPECT_EQ(JointNames(all), JointNames(tree));
  ASSERT_EQ(all.links.size(), tree.links.size());
  for (std::size_t i = 0; i < tree.links.size(); ++i) {
    EXPECT_EQ(all.links[i].name, tree.links[i].name);
  }
}

TEST(Subtree, KinematicsAreThoseOfTheTree) {
  for (int seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    const RobotTree tree = RandomRobot(kUsualRelations, random);
    const Eigen::VectorXd q = RandomPosture(tree, random);
    const std::vector<Transform> T_root_link = LinkTransforms(tree, q);
    for (int link = 0; link < static_cast<int>(tree.links.size()); ++link) {
      const RobotTree subtree = Subtree(tree, link);
      Eigen::VectorXd subtree_q(subtree.coordinate_count());
      for (const Joint& joint : subtree.joints) {
        subtree_q[joint.coordinate] = q[tree.joints[FindJoint(tree, joint.name)].coordinate];
      }
      const std::vector<Transform> T = LinkTransforms(subtree, subtree_q);
      const int root = FindLink(tree, subtree.links[0].name);
      for (std::size_t i = 0; i < subtree.links.size(); ++i) {
        const Transform expected =
            T_root_link[root].inverse() * T_root_link[FindLink(tree, subtree.links[i].name)];
        // Accumulated rounding along up to nine joints.
        EXPECT_LT((T[i].matrix() - expected.matrix()).norm(), 1e-14) << subtree.links[i].name;
      }
    }
  }
}

TEST(Subtree, ACoordinateBelongsToTheLeaderThoughAMimicComesFirst) {
  RobotTree tree = MakeRoot();
  const int first = AddJoint(tree, "mimic", 0, Transform::Identity(), {0, 0, 1});
  const int second = AddJoint(tree, "leader", first, Transform::Identity(), {0, 0, 1});
  AddJoint(tree, "free", second, Transform::Identity(), {0, 0, 1});
  tree.joints[0].mimic = true;
  tree.joints[1].coordinate = 0;
  tree.joints[2].coordinate = 1;
  tree.coordinate_joint = {1, 2};
  const RobotTree subtree = Subtree(tree, 0);
  EXPECT_EQ(subtree.coordinate_joint, tree.coordinate_joint);
}

TEST(SubtreeMarkers, AreThoseOnItsLinks) {
  const RobotTree tree = RailArm();
  const std::vector<Marker> markers = {{"A", FindLink(tree, "finger_1_link"), {1, 2, 3}},
                                       {"B", FindLink(tree, "rail_link"), {}},
                                       {"C", FindLink(tree, "flange"), {4, 5, 6}}};
  const RobotTree subtree = Subtree(tree, FindLink(tree, "arm_link"));
  const std::vector<Marker> inside = SubtreeMarkers(tree, subtree, markers);
  ASSERT_EQ(inside.size(), 2u);
  EXPECT_EQ(inside[0].name, "A");
  EXPECT_EQ(subtree.links[inside[0].link].name, "finger_1_link");
  EXPECT_EQ(inside[0].p_link_marker, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(inside[1].name, "C");
  EXPECT_EQ(subtree.links[inside[1].link].name, "flange");
}

}  // namespace
}  // namespace elastocal
