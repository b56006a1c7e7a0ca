// SPDX-License-Identifier: Apache-2.0
// Recordings of two robots, or of one whose markers were glued on anew, given as one.
#include "elastocal/mistakes/recordings_apart.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/recorded/recorded_model.hpp"
#include "tests/standing_robot.hpp"

namespace elastocal {
namespace {

class RecordingsApart : public testing::Test {
 protected:
  Recording Record(const Eigen::VectorXd& truth, const std::string& folder, int session) const {
    Recording recording = robot_.Record(truth, {.marker_sd = 2e-4,
                                                .torque_sd = 0.1,
                                                .torque_sensors = robot_.project.torque_sensors,
                                                .seed = 1 + static_cast<std::uint64_t>(session)});
    for (Trial& trial : recording.trials) {
      trial.name = folder + "/" + trial.name;
      trial.session = session;
    }
    return recording;
  }

  /// Of both together, the second robot having the errors `second`.
  std::string Said(const Eigen::VectorXd& second) const {
    return SaidOf(JoinTrials(Record(truth_, "monday", 0), Record(second, "friday", 1)));
  }

  std::string SaidOf(const Recording& both) const {
    const RecordedModel robot{robot_.model, robot_.base};
    const CalibrationResult fit =
        Calibrate(robot.model, both, robot.base, ModelKinds(robot.model).back(), {});
    return FindRecordingsApart(robot_.project, robot, both, fit);
  }

  int marker_parameters() const { return 3 * robot_.model.marker_count(); }

  StandingRobot robot_{8};
  Eigen::VectorXd truth_ = robot_.DrawTruth(4), other_ = robot_.DrawTruth(5);
};

TEST_F(RecordingsApart, OneRobotOnTwoDaysIsOneRobot) { EXPECT_EQ(Said(truth_), ""); }

TEST_F(RecordingsApart, AnotherRobotIsNotTheSame) {
  const std::string said = Said(other_);
  EXPECT_EQ(said.find("the recordings are not of one robot in one state"), 0u) << said;
  EXPECT_NE(said.find("each by itself monday "), std::string::npos) << said;
  EXPECT_NE(said.find(" mm, friday "), std::string::npos) << said;
}

TEST_F(RecordingsApart, TrialsOfAnotherRobotAreNamed) {
  const Recording own = Record(truth_, "monday", 0), foreign = Record(other_, "monday", 0);
  const auto mixed_with = [&](const std::vector<std::string>& trials) {
    Recording mixed = own;
    for (int i = 0; i < mixed.posture_count(); ++i) {
      if (std::ranges::count(trials, mixed.trials[Size(mixed.trial[Size(i)])].name) == 0) continue;
      mixed.q.row(i) = foreign.q.row(i);
      mixed.markers.row(i) = foreign.markers.row(i);
      mixed.torques.row(i) = foreign.torques.row(i);
    }
    return SaidOf(mixed);
  };
  EXPECT_EQ(mixed_with({}), "");
  const std::string one = mixed_with({"monday/leg_left"});
  EXPECT_NE(one.find(", another one monday/leg_left ("), std::string::npos) << one;
  const std::string two = mixed_with({"monday/torso_arm_left", "monday/torso_arm_right"});
  EXPECT_NE(two.find("monday/torso_arm_left, monday/torso_arm_right ("), std::string::npos) << two;
  EXPECT_NE(two.find("monday/leg_left, monday/leg_right ("), std::string::npos) << two;
}

TEST_F(RecordingsApart, MarkersThatWereGluedOnAnewAreNoOtherRobot) {
  Eigen::VectorXd glued = truth_;
  glued.tail(marker_parameters()) = other_.tail(marker_parameters());
  const std::string said = Said(glued);
  EXPECT_EQ(said.find("the markers of the recordings are not in the same places"), 0u) << said;
}

}  // namespace
}  // namespace elastocal
