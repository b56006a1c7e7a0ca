// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/observation_faults.hpp"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "elastocal/observation/observed_posture.hpp"
#include "tests/touching_biped.hpp"

namespace elastocal {
namespace {

/// First the touches of the left hand, during which the right arm rests, then those of the right
/// hand.
Observations LeftThenRight(const Observations& mixed, const RobotTree& tree) {
  const auto is_left = [&](int i) {
    return mixed.all[static_cast<std::size_t>(i)].instrument == 0;
  };
  std::vector<int> order(static_cast<std::size_t>(mixed.posture_count()));
  std::iota(order.begin(), order.end(), 0);
  const auto right = std::stable_partition(order.begin(), order.end(), is_left);
  Observations touches = SelectPostures(mixed, order);
  const auto rests = static_cast<Eigen::Index>(right - order.begin());
  for (const Joint& joint : tree.joints) {
    if (joint.name.starts_with("arm_right")) touches.q.col(joint.coordinate).head(rests).setZero();
  }
  return touches;
}

bool AnyFrozen(const std::vector<ObservationFault>& faults) {
  return std::any_of(faults.begin(), faults.end(), [](const ObservationFault& fault) {
    return fault.kind == ObservationFaultKind::kJointFrozen;
  });
}

// The left hand's touches have larger errors, but the resting right arm does not move that hand.
TEST(ObservationFaults, AnArmThatRestsWhileTheOtherTouchesIsNotFrozen) {
  const ObservedRobot model = MakeTouchingBiped();
  Random random(4);
  const ObservedValues truth = RandomTruth(model, 1, random);
  Observations touches = LeftThenRight(
      SimulateTouches(model, truth, 40, 1, {1e-4, 1e-3, 1e-3}, random), model.robot.tree);
  const auto wrist = model.robot.tree.joints[FindJoint(model.robot.tree, "arm_left_5")].coordinate;
  touches.q.col(wrist).head(20) += random.NormalVector(20, 5e-3);
  EXPECT_FALSE(
      AnyFrozen(FindObservationFaults(model, touches, EstimateObserved(model, touches, {}).fit)));
  touches.q.col(wrist).segment(5, 6).setConstant(touches.q(5, wrist) + 0.4);
  EXPECT_TRUE(
      AnyFrozen(FindObservationFaults(model, touches, EstimateObserved(model, touches, {}).fit)));
}

}  // namespace
}  // namespace elastocal
