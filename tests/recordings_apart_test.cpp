// SPDX-License-Identifier: Apache-2.0
// Recordings of two robots, or of one robot whose markers were glued on anew, given as one
// recording.
#include "elastocal/mistakes/recordings_apart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/mistakes/find_contradictions.hpp"
#include "elastocal/mistakes/find_faults.hpp"
#include "elastocal/mistakes/placed_offset.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/mistakes/trial_offset.hpp"
#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/validation/held_out.hpp"
#include "elastocal/validation/model_comparison.hpp"
#include "tests/standing_humanoid.hpp"

namespace elastocal {
namespace {

class RecordingsApart : public testing::Test {
 protected:
  Recording Record(const Eigen::VectorXd& truth, const std::string& folder, int session,
                   double marker_sd = 2e-4) const {
    Recording recording = robot_.Record(truth, {.marker_sd = marker_sd,
                                                .torque_sd = 0.1,
                                                .torque_sensors = robot_.project.torque_sensors,
                                                .seed = 1 + static_cast<std::uint64_t>(session)});
    for (Trial& trial : recording.trials) {
      trial.name = folder + "/" + trial.name;
      trial.session = session;
    }
    return recording;
  }

  /// The message about two recordings together. The second robot has the errors `second`.
  std::string Said(const Eigen::VectorXd& second) const {
    return SaidOf(JoinTrials(Record(truth_, "monday", 0), Record(second, "friday", 1)));
  }

  CalibrationResult FitOf(const Recording& recording) const {
    return Calibrate(robot_.model, recording, robot_.base, ModelKinds(robot_.model).back(), {});
  }
  double LeftOf(const Recording& recording) const {
    return MarkerError(FitOf(recording), recording, {});
  }

  std::string SaidOf(const Recording& recording) const {
    const auto apart =
        FindRecordingsApart(robot_.project, {robot_.model, robot_.base}, recording,
                            FitOf(recording), std::numeric_limits<double>::infinity());
    return apart ? apart->said : "";
  }

  /// The faults that `calibrate` reports.
  std::string FaultsOf(const Recording& recording, const Recording& validation = {}) const {
    ModelComparison comparison;
    const CalibrationResult fit = FitOf(recording);
    comparison.kinds = {fit.kind};
    comparison.results[static_cast<std::size_t>(fit.kind)] = fit;
    Measurements measured;
    measured.calibration = recording;
    measured.validation = validation;
    std::string all;
    for (const std::string& fault : FindFaults(
             robot_.project, {}, measured, {robot_.model, robot_.base}, recording, comparison)) {
      all += fault + "\n";
    }
    return all;
  }

  int marker_parameters() const { return 3 * robot_.model.marker_count(); }

  StandingHumanoid robot_{8};
  Eigen::VectorXd truth_ = robot_.DrawTruth(4), other_ = robot_.DrawTruth(5);
};

TEST_F(RecordingsApart, OneRobotOnTwoDaysIsOneRobot) { EXPECT_EQ(Said(truth_), ""); }

TEST_F(RecordingsApart, AnotherRobotIsNotTheSame) {
  const std::string said = Said(other_);
  EXPECT_EQ(said.find("the recordings are not of one robot in one state"), 0u) << said;
  EXPECT_NE(said.find("each by itself monday "), std::string::npos) << said;
  EXPECT_NE(said.find(" mm, friday "), std::string::npos) << said;
}

// Errors that no robot of the model has do not indicate another robot, however large they are.
TEST_F(RecordingsApart, ErrorsThatAPostureSharesAreNoOtherRobot) {
  Recording recording = Record(truth_, "monday", 0);
  Random random(3);
  const std::vector<Link>& links = robot_.model.tree.links;
  for (int i = 0; i < recording.posture_count(); ++i) {
    std::map<int, Eigen::Vector3d> of_body;
    for (int m = 0; m < recording.marker_count(); ++m) {
      const int body = links[Size(robot_.model.markers[Size(m)].link)].body;
      if (!of_body.contains(body)) of_body[body] = random.NormalVector(3, 1.5e-3);
      recording.markers.block<1, 3>(i, 3 * m) += of_body[body].transpose();
    }
  }
  EXPECT_TRUE(LeavesMoreThanCameras(FitOf(recording), LeftOf(recording)));
  EXPECT_EQ(SaidOf(recording), "");
}

TEST_F(RecordingsApart, AnEncoderOffCentreIsNoOtherRobot) {
  Recording recording = Record(truth_, "monday", 0);
  for (const char* name : {"arm_left_2_joint", "arm_right_4_joint", "leg_left_3_joint"}) {
    const Joint& joint = robot_.project.tree.joints[FindJoint(robot_.project.tree, name)];
    auto q = recording.q.col(joint.coordinate);
    q.array() += 0.015 * (3.0 * q.array()).sin();
  }
  EXPECT_TRUE(LeavesMoreThanCameras(FitOf(recording), LeftOf(recording)));
  EXPECT_EQ(SaidOf(recording), "");
}

// In fifteen trials, a joint lags behind its motor to either side.
TEST_F(RecordingsApart, HysteresisInManyTrialsIsNoOtherRobot) {
  Recording all = JoinTrials(JoinTrials(Record(truth_, "a", 0), Record(truth_, "b", 1)),
                             Record(truth_, "c", 2));
  for (Trial& trial : all.trials) trial.session = 0;
  ASSERT_EQ(all.trials.size(), 15u);
  const RobotTree& tree = robot_.project.tree;
  for (const char* name : {"torso_1_joint", "arm_left_2_joint", "leg_left_3_joint"}) {
    const int joint = tree.joints[FindJoint(tree, name)].coordinate;
    for (int i = all.posture_count() - 1; i > 0; --i) {
      all.q(i, joint) += all.q(i, joint) > all.q(i - 1, joint) ? 0.01 : -0.01;
    }
  }
  const CalibrationResult fit = FitOf(all);
  EXPECT_TRUE(LeavesMoreThanCameras(fit, MarkerError(fit, all, {})));
  EXPECT_EQ(SaidOf(all), "");
}

TEST_F(RecordingsApart, TrialsOfAnotherRobotAreNamed) {
  const Recording own = Record(truth_, "monday", 0), foreign = Record(other_, "monday", 0);
  const auto mixed = [&](const std::vector<std::string>& trials) {
    Recording of_both = own;
    for (int i = 0; i < own.posture_count(); ++i) {
      if (std::ranges::count(trials, own.trials[Size(own.trial[Size(i)])].name) == 0) continue;
      of_both.q.row(i) = foreign.q.row(i);
      of_both.markers.row(i) = foreign.markers.row(i);
      of_both.torques.row(i) = foreign.torques.row(i);
    }
    return of_both;
  };
  const auto mixed_with = [&](const std::vector<std::string>& trials) {
    return SaidOf(mixed(trials));
  };
  EXPECT_EQ(mixed_with({}), "");
  const std::string one = mixed_with({"monday/leg_left"});
  EXPECT_NE(one.find("; another one monday/leg_left ("), std::string::npos) << one;
  EXPECT_NE(FaultsOf(mixed({"monday/leg_left"})).find(one), std::string::npos)
      << "not asked for by calibrate";
  const std::string two = mixed_with({"monday/torso_arm_left", "monday/torso_arm_right"});
  EXPECT_NE(two.find("monday/torso_arm_left, monday/torso_arm_right ("), std::string::npos) << two;
  EXPECT_NE(two.find("monday/leg_left, monday/leg_right ("), std::string::npos) << two;
}

// One of fifteen trials is foreign. Without the half that contains it, the others are combined at
// once.
TEST_F(RecordingsApart, AForeignTrialIsFoundAmongMany) {
  const Recording foreign = Record(other_, "c", 2);
  Recording third = Record(truth_, "c", 2);
  for (int i = 0; i < third.posture_count(); ++i) {
    if (third.trials[Size(third.trial[Size(i)])].name != "c/leg_left") continue;
    third.q.row(i) = foreign.q.row(i);
    third.markers.row(i) = foreign.markers.row(i);
    third.torques.row(i) = foreign.torques.row(i);
  }
  Recording all = JoinTrials(JoinTrials(Record(truth_, "a", 0), Record(truth_, "b", 1)), third);
  for (Trial& trial : all.trials) trial.session = 0;
  ASSERT_EQ(all.trials.size(), 15u);
  const std::string said = SaidOf(all);
  EXPECT_NE(said.find("; another one c/leg_left ("), std::string::npos) << said;
}

// The joint is homed anew before the trial of the other leg. This causes less than half of the
// squares, and a separate robot for each trial would explain as much.
TEST_F(RecordingsApart, AJointThatWasHomedAnewIsFoundInAnyTrial) {
  Recording recording = Record(truth_, "monday", 0);
  const RobotTree& tree = robot_.project.tree;
  const int joint = tree.joints[FindJoint(tree, "leg_left_3_joint")].coordinate;
  for (int i = 0; i < recording.posture_count(); ++i) {
    const std::string& trial = recording.trials[Size(recording.trial[Size(i)])].name;
    if (trial == "monday/leg_right") recording.q(i, joint) += 0.06;
  }
  const CalibrationResult fit = FitOf(recording);
  EXPECT_FALSE(FindTrialOffset(fit, robot_.base, recording, {}));
  const auto found = FindTrialOffset(fit, robot_.base, recording, {}, {}, OffsetTrials::kAny);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->coordinate, joint);
  EXPECT_EQ(recording.trials[Size(found->trial)].name, "monday/leg_right");
  EXPECT_NEAR(found->size, 0.06, 0.01);  // the fit has spread a part of the error
  const std::string said = FaultsOf(recording);
  const std::string name = "--accept offset:leg_left_3_joint@monday/leg_right=";
  ASSERT_NE(said.find(name), std::string::npos) << said;
  const double corrected = std::stod(said.substr(said.find(name) + name.size()));  // degrees
  EXPECT_NEAR(corrected, 0.06 * 180.0 / M_PI, 0.1) << said;
}

class OffsetsOfLegs : public RecordingsApart {
 protected:
  Recording OfLegs(const std::string& folder, int session) const {
    // The noise is small, because the length of the leg magnifies errors of a foot's attitude.
    const Recording all = Record(truth_, folder, session, 3e-5);
    std::vector<int> postures;
    for (int i = 0; i < all.posture_count(); ++i) {
      const std::string& name = all.trials[Size(all.trial[Size(i)])].name;
      if (name.find("/leg_") != std::string::npos) postures.push_back(i);
    }
    return SelectPostures(all, postures);
  }

  RecordingFault InTrial(const Recording& recording, const std::string& name, double size) const {
    RecordingFault fault{.kind = FaultKind::kJointOffset, .coordinate = joint_, .size = size};
    while (recording.trials[Size(recording.trial[Size(fault.posture)])].name != name) {
      ++fault.posture;
    }
    fault.trial = recording.trial[Size(fault.posture)];
    return fault;
  }

  void PutIn(const RecordingFault& fault, Recording& recording) const {
    for (int i = 0; i < recording.posture_count(); ++i) {
      if (recording.trial[Size(i)] == fault.trial) recording.q(i, joint_) += fault.size;
    }
  }

  GeneralFault General(const RecordingFault& fault, const Recording& recording) const {
    return {fault, robot_.model,        robot_.base, recording, ModelKinds(robot_.model).back(),
            {},    OfLegs("tuesday", 9)};
  }

  const RobotTree& tree_ = robot_.project.tree;
  int joint_ = tree_.joints[FindJoint(tree_, "leg_left_3_joint")].coordinate;
};

// Two trials show the joint. It is off in one, or by the opposite in the other. Held-out trials
// tell which.
TEST_F(OffsetsOfLegs, AnOffsetIsInTheTrialThatContradictsHeldOutOnes) {
  Recording recording = OfLegs("monday", 0);
  const RecordingFault left = InTrial(recording, "monday/leg_left", -0.02);
  const RecordingFault right = InTrial(recording, "monday/leg_right", 0.02);
  PutIn(left, recording);
  for (const RecordingFault& named : {left, right}) {
    const PlacedOffset placed = PlaceOffset(named, General(named, recording));
    EXPECT_TRUE(placed.told);
    EXPECT_EQ(placed.fault.trial, left.trial);
    EXPECT_NEAR(placed.fault.size, left.size, 2e-3);
  }
}

// The joint is off in three of four trials. So it seems off in the fourth, and no other single
// trial explains this.
TEST_F(OffsetsOfLegs, AnOffsetThatHeldOutTrialsRefuteIsSaidToBeDoubtful) {
  Recording recording = JoinTrials(OfLegs("monday", 0), OfLegs("friday", 1));
  for (const char* off : {"monday/leg_left", "monday/leg_right", "friday/leg_left"}) {
    PutIn(InTrial(recording, off, 0.02), recording);
  }
  const RecordingFault named = InTrial(recording, "friday/leg_right", -0.02);
  const GeneralFault general = General(named, recording);
  const PlacedOffset placed = PlaceOffset(named, general);
  EXPECT_FALSE(placed.told);
  EXPECT_TRUE(placed.refuted);
  EXPECT_EQ(placed.fault.trial, named.trial);
  const FaultsInWords words = ExplainFault(general, robot_.project);
  EXPECT_NE(words.text.find(kOrInAllOthers), std::string::npos) << words.text;
}

class HeldOutTrials : public RecordingsApart {
 protected:
  /// What contradicts the estimate in held-out trials of a robot with these errors.
  std::string Contradictions(const Eigen::VectorXd& truth) const {
    const Recording own = Record(truth_, "monday", 0), held_out = Record(truth, "friday", 1);
    ModelComparison comparison;
    comparison.kinds = {ModelKind::kUncalibrated, ModelKinds(robot_.model).back()};
    for (const ModelKind kind : comparison.kinds) {
      comparison.results[static_cast<std::size_t>(kind)] =
          Calibrate(robot_.model, own, robot_.base, kind, {});
    }
    const ErrorTable table = JudgeOnTrials(comparison, held_out, {}).table;
    std::string all;
    for (const std::string& one : FindContradictions(robot_.project, {robot_.model, robot_.base},
                                                     own, held_out, comparison, table)) {
      all += one + "\n";
    }
    return all;
  }
};

// All clusters seem displaced, so that none of them was knocked.
TEST_F(HeldOutTrials, OfAnotherRobotAreSaidToBe) {
  EXPECT_EQ(Contradictions(truth_), "");
  const std::string other = Contradictions(other_);
  EXPECT_NE(other.find("robots of their own"), std::string::npos) << other;
}

TEST_F(HeldOutTrials, WithMarkersThatWereGluedOnAnewAreOfTheSameRobot) {
  Eigen::VectorXd glued = truth_;
  glued.tail(marker_parameters()) = other_.tail(marker_parameters());
  const std::string said = Contradictions(glued);
  EXPECT_NE(said, "");
  EXPECT_EQ(said.find("robots of their own"), std::string::npos) << said;
}

// From the trials of the estimate alone, it would be a scale of all trials, and less exactly known.
TEST_F(RecordingsApart, AScaleOfTheEstimatesTrialsIsToldFromOneOfAll) {
  Recording own = Record(truth_, "monday", 0);
  own.markers *= 1.03;
  const std::string said = FaultsOf(own, Record(truth_, "friday", 1));
  EXPECT_NE(said.find("camera positions are 1.0300 times the true ones in trial monday/"),
            std::string::npos)
      << said;
  EXPECT_NE(said.find("--accept scale:monday/"), std::string::npos) << said;
}

TEST_F(RecordingsApart, MarkersThatWereGluedOnAnewAreNoOtherRobot) {
  Eigen::VectorXd glued = truth_;
  glued.tail(marker_parameters()) = other_.tail(marker_parameters());
  const std::string said = Said(glued);
  EXPECT_EQ(said.find("the markers of the recordings are not in the same places"), 0u) << said;
}

}  // namespace
}  // namespace elastocal
