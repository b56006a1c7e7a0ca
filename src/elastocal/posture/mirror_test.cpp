// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/mirror.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

/// Two arms of three joints. `flip` reverses the axes of the right one.
RobotTree TwoArms(bool flip) {
  RobotTree tree = MakeRoot();
  int left = AddJoint(tree, "l1", 0, Offset(0, 0.2, 0.3), {0, 0, 1});
  left = AddJoint(tree, "l2", left, Offset(0, 0.1, 0), {1, 0, 0});
  AddJoint(tree, "l3", left, Offset(0, 0, -0.3), {0, 1, 0});
  const double sign = flip ? -1.0 : 1.0;
  int right = AddJoint(tree, "r1", 0, Offset(0, -0.2, 0.3), {0, 0, sign});
  right = AddJoint(tree, "r2", right, Offset(0, -0.1, 0), {sign, 0, 0});
  AddJoint(tree, "r3", right, Offset(0, 0, -0.3), {0, sign, 0});
  return tree;
}

class BothConventions : public testing::TestWithParam<bool> {};

TEST_P(BothConventions, MirroredPosturesAreMirrorImages) {
  const RobotTree tree = TwoArms(GetParam());
  const auto mirror = FindMirror(tree, {0, 1, 2}, {3, 4, 5});
  ASSERT_TRUE(mirror);
  Random random(1);
  for (int i = 0; i < 20; ++i) {
    Eigen::VectorXd q(6);
    for (int k = 0; k < 3; ++k) q[k] = random.Uniform(-1.0, 1.0);
    q.tail<3>() = mirror->sign.cwiseProduct(q.head<3>());
    const auto poses = LinkTransforms(tree, q);
    const Eigen::Vector3d p(0.1, 0.2, -0.3);
    const Eigen::Vector3d left = poses[FindLink(tree, "l3_link")] * p;
    const Eigen::Vector3d right =
        poses[FindLink(tree, "r3_link")] * Eigen::Vector3d(p.x(), -p.y(), p.z());
    EXPECT_LT((right - Eigen::Vector3d(left.x(), -left.y(), left.z())).norm(), 1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(Axes, BothConventions, testing::Bool());

TEST(FindMirror, SaysWhyThereIsNone) {
  RobotTree tree = TwoArms(false);
  tree.joints[4].axis = {0, 1, 0};
  std::string reason;
  EXPECT_FALSE(FindMirror(tree, {0, 1, 2}, {3, 4, 5}, &reason));
  EXPECT_EQ(reason, "the axes of l2 and r2 are not mirror images");
  EXPECT_FALSE(FindMirror(tree, {0, 1, 2}, {3, 4}, &reason));
}

}  // namespace
}  // namespace elastocal
