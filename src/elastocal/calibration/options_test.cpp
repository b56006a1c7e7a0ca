// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/options.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

// By hand: a deflection under the largest torque or force. A slide's spring is no turn.
TEST(Prior, SpringsFollowFromTheEffortOfTheirJoint) {
  RobotTree tree;
  tree.joints.resize(1);
  Parameter spring{};
  spring.kind = ParameterKind::kTorsion;
  spring.joint = 0;
  Joint& joint = tree.joints[0];
  const Prior prior;
  joint.limits.effort = 100.0;
  EXPECT_DOUBLE_EQ(prior.Of(tree, spring), 1e-4);  // 10 mrad
  joint.type = JointType::kPrismatic;
  joint.limits.effort = 2000.0;
  EXPECT_DOUBLE_EQ(prior.Of(tree, spring), 5e-7);  // 1 mm
  joint.limits.effort = std::numeric_limits<double>::infinity();
  EXPECT_DOUBLE_EQ(prior.Of(tree, spring), 1e-6);
  joint.type = JointType::kRevolute;
  EXPECT_DOUBLE_EQ(prior.Of(tree, spring), 5e-5);
}

}  // namespace
}  // namespace elastocal
