// SPDX-License-Identifier: Apache-2.0
// Faults of a recording that contradict an earlier calibration of the same robot.
#include "elastocal/mistakes/transfer_faults.hpp"

#include <cmath>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "elastocal/elastocal.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

constexpr double kTurnDegree = M_PI / 180.0;

/// An arm with known errors, in two trials.
class TransferFaults : public testing::Test {
 protected:
  Recording Trial(const std::string& name, std::uint64_t seed) const {
    return TrialOf(model_, name, seed);
  }

  Recording TrialOf(const ErrorModel& model, const std::string& name, std::uint64_t seed) const {
    Recording recording = MakeSyntheticRecording(model, truth_, {.postures = 24, .seed = seed});
    recording.trials = {{name, TrialKind::kRandom, {project_.chains.front().name}}};
    recording.trial.assign(24, 0);
    return recording;
  }

  Refit Fitted(const Recording& recording) const {
    return RefitTo(model_, recording, base_, project_.calibration, errors_);
  }

  std::vector<std::string> Found() const {
    const RecordedModel robot{model_, base_};
    const TransferValidation transfer =
        ValidateTransfer(model_, recorded_, base_, project_.calibration, errors_);
    Measurements measured;
    measured.calibration = recorded_;
    const double expected = clean_;
    return FindTransferFaults({.project = project_,
                               .robot = robot,
                               .as_recorded = measured,
                               .recording = recorded_,
                               .transfer = transfer,
                               .joint_errors = errors_,
                               .expected = expected,
                               .holds = [&](const Measurements& corrected) {
                                 return Fitted(corrected.calibration).metrics_all.rmse_3d <
                                        1.5 * expected;
                               }});
  }

  void Turn(const std::string& joint, double degrees, int begin, int end) {
    const int coordinate = project_.tree.joints[FindJoint(project_.tree, joint)].coordinate;
    recorded_.q.col(coordinate).segment(begin, end - begin).array() += degrees * kTurnDegree;
  }

  void ExpectFound(const std::vector<std::string>& parts) const {
    const std::vector<std::string> found = Found();
    ASSERT_EQ(found.size(), 1u);
    for (const std::string& part : parts) {
      EXPECT_NE(found[0].find(part), std::string::npos) << part << ": " << found[0];
    }
  }

  Project project_ = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  ErrorModel model_ = MakeErrorModel(project_.tree, project_.markers, project_.placement);
  BaseParameters base_ = FindBaseParameters(model_, project_.identifiability);
  Eigen::VectorXd truth_ = DrawErrors(model_, base_.kept, {{ParameterKind::kTheta, 0.01}}, 1);
  std::map<std::string, double> errors_ = [this] {
    std::map<std::string, double> errors;
    for (int i = 0; i < model_.parameter_count(); ++i) {
      if (IsExternal(model_.parameters[i].kind)) continue;
      errors[model_.parameters[i].name] = truth_[i];
    }
    return errors;
  }();
  Recording recorded_ = JoinTrials(Trial("morning", 1), Trial("evening", 2));
  double clean_ = Fitted(recorded_).metrics_all.rmse_3d;
};

// Trials that agree with the calibration tell that the trial that contradicts it is at fault.
TEST_F(TransferFaults, AJointThatIsOffInOneTrialIsAFaultOfTheTrial) {
  EXPECT_TRUE(Found().empty());
  Turn("elbow_joint", 2.0, 24, 48);
  ExpectFound({"contradict each other", "elbow_joint: its positions are off by 1.99",
               "--accept offset:elbow_joint@evening=1.99"});
  EXPECT_EQ(Found()[0].find("moved since"), std::string::npos) << Found()[0];
}

// Nothing tells whether the robot or the log has changed, so the message names both.
TEST_F(TransferFaults, AJointThatIsOffInAllTrialsMayHaveMoved) {
  Turn("elbow_joint", 2.0, 0, 48);
  ExpectFound(
      {"elbow_joint: its positions are off by 1.997 +- 0.002 deg (--accept "
       "offset:elbow_joint@morning=1.9975 offset:elbow_joint@evening=1.9975 ",
       "elbow_joint may as well have moved since the calibration"});
}

TEST_F(TransferFaults, AScaleOfTheCamerasIsNamed) {
  recorded_.markers *= 1.01;
  ExpectFound({"the cameras' positions are 1.00", "--accept scale=1.0099"});
}

TEST_F(TransferFaults, AGainInOneTrialIsNamed) {
  const int coordinate =
      project_.tree.joints[FindJoint(project_.tree, "shoulder_joint")].coordinate;
  recorded_.q.col(coordinate).head(24) *= 1.03;
  ExpectFound({"shoulder_joint: its positions are 1.0300", "in trial morning"});
}

TEST_F(TransferFaults, AClusterThatIsElsewhereInOneTrialIsNamed) {
  ErrorModel moved = model_;
  for (Marker& marker : moved.markers) {
    if (marker.name.starts_with("FOREARM")) marker.p_link_marker.y() += 9e-3;
  }
  recorded_ = JoinTrials(Trial("morning", 1), TrialOf(moved, "evening", 2));
  ExpectFound({"cluster FOREARM", "in trial morning than in the others", "by 8.97 mm"});
}

// A table has no trials.
TEST_F(TransferFaults, AJointThatIsOffInATableMayHaveMoved) {
  recorded_.trials.clear();
  recorded_.trial.clear();
  Turn("elbow_joint", 2.0, 0, 48);
  ExpectFound(
      {"elbow_joint: its positions are off by 1.997 +- 0.002 deg; elbow_joint may as well"});
}

}  // namespace
}  // namespace elastocal
