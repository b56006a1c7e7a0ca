// SPDX-License-Identifier: Apache-2.0
// The project says that a joint stood still, but the markers show that it moved.
#include "elastocal/mistakes/unrecorded_motion.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/robot/coordinates.hpp"
#include "tests/standing_humanoid.hpp"

namespace elastocal {
namespace {

class UnrecordedMotion : public testing::Test {
 protected:
  int CoordinateOf(const std::string& joint) const {
    for (int c = 0; c < tree_.coordinate_count(); ++c) {
      if (JointOfCoordinate(tree_, c).name == joint) return c;
    }
    return -1;
  }

  /// The message if the joint was not recorded and stands at 0.1 rad in the project. In postures
  /// `begin` to `end` of each trial it was elsewhere.
  std::string Said(const std::string& joint, int begin, int end) {
    const int c = CoordinateOf(joint);
    for (PlayedTrial& trial : robot_.trials) {
      for (int i = 0; i < trial.q.rows(); ++i) {
        if (i < begin || i >= end) trial.q(i, c) = 0.1;
      }
    }
    Recording recording = robot_.Record(robot_.DrawTruth(4), {.marker_sd = 2e-4});
    recording.q.col(c).setConstant(0.1);
    recording.joints_not_recorded = {joint};
    const RecordedModel robot{robot_.model, robot_.base};
    const CalibrationResult fit =
        Calibrate(robot.model, recording, robot.base, ModelKinds(robot.model).back(), {});
    return FindUnrecordedMotion(robot_.project, robot, recording, fit);
  }

  StandingHumanoid robot_{8};
  const RobotTree& tree_ = robot_.project.tree;
};

TEST_F(UnrecordedMotion, OfAJointThatStoodStillThereIsNone) {
  EXPECT_EQ(Said("head_1_joint", 0, 0), "");
}

TEST_F(UnrecordedMotion, InTwoPosturesIsNamedWithThem) {
  const std::string said = Said("head_1_joint", 3, 5);
  EXPECT_EQ(said.find("head_1_joint is not recorded, and the project says that it stood still at "
                      "5.73 deg: the markers show it between 5.73 and "),
            0u)
      << said;
  EXPECT_NE(said.find("in 2 of 40 postures elsewhere than usual, first in trial head_trunk"),
            std::string::npos)
      << said;
}

TEST_F(UnrecordedMotion, InAllPosturesIsNamed) {
  const std::string said = Said("arm_left_5_joint", 0, 8);
  EXPECT_EQ(said.find("arm_left_5_joint is not recorded"), 0u) << said;
}

}  // namespace
}  // namespace elastocal
