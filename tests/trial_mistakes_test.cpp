// SPDX-License-Identifier: Apache-2.0
// Mistakes of a laboratory in trials: they are named, and undone on request.

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "elastocal/elastocal.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/find_contradictions.hpp"
#include "elastocal/mistakes/log_alternatives.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

class TrialMistakes : public testing::Test {
 protected:
  /// 40 postures of a robot with these errors as one trial.
  Recording AsTrial(const ErrorModel& model, const Eigen::VectorXd& truth, const std::string& name,
                    TrialKind kind, std::uint64_t seed) const {
    Recording recording = MakeSyntheticRecording(model, truth, {.postures = 40, .seed = seed});
    recording.trials = {{name, kind, {project_.chains.front().name}}};
    recording.trial.assign(40, 0);
    return recording;
  }

  Project project_ = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
};

// If there is one trial for the estimate, it cannot show that a joint is off: the fit takes this
// for an error of the robot. The held-out trial shows it.
TEST_F(TrialMistakes, AFaultOfTheOnlyTrialIsNamedByTheHeldOutOne) {
  const ErrorModel model = MakeErrorModel(project_.tree, project_.markers, project_.placement);
  const BaseParameters base = FindBaseParameters(model, project_.identifiability);
  const Eigen::VectorXd truth = DrawErrors(model, base.kept, {{ParameterKind::kTheta, 0.01}}, 1);
  const auto as_trial = [&](const std::string& name, TrialKind kind, std::uint64_t seed) {
    return AsTrial(model, truth, name, kind, seed);
  };
  const auto estimate = [&](const Recording& recording) {
    return CompareModels(Calibrate(model, recording, base, ModelKind::kGeometric, {}), model,
                         recording, base, {});
  };
  const auto contradictions = [&](const Recording& recording, const Recording& held_out) {
    const ModelComparison comparison = estimate(recording);
    const HeldOut judged = JudgeOnTrials(comparison, held_out, {});
    return FindContradictions(project_, {model, base}, recording, held_out, comparison,
                              judged.table);
  };
  const auto left_out = [&](const Recording& recording, Recording& held_out) {
    const ModelComparison comparison = estimate(recording);
    const HeldOut judged = JudgeOnTrials(comparison, held_out, {});
    return LeaveOutBriefExchange(project_, recording, comparison, judged.table, held_out);
  };
  Recording recording = as_trial("swing", TrialKind::kCalibration, 1);
  const Recording held_out = as_trial("check", TrialKind::kRandom, 2);
  EXPECT_TRUE(contradictions(recording, held_out).empty());

  const std::vector<int>& markers = project_.clusters.back().markers;
  Recording exchanged = recording;
  exchanged.markers.middleCols<3>(3 * markers[0])
      .swap(exchanged.markers.middleCols<3>(3 * markers[1]));
  const std::vector<std::string> labels = contradictions(exchanged, held_out);
  ASSERT_EQ(labels.size(), 1u);
  EXPECT_NE(labels[0].find("seem exchanged in trial swing"), std::string::npos) << labels[0];
  Recording in_part = held_out;
  in_part.markers.block(10, 3 * markers[0], 8, 3)
      .swap(in_part.markers.block(10, 3 * markers[1], 8, 3));
  const std::string part = left_out(recording, in_part);
  EXPECT_NE(part.find("seem exchanged in 8 postures of trial check"), std::string::npos) << part;
  EXPECT_NE(part.find("left out"), std::string::npos) << part;
  EXPECT_TRUE(in_part.markers.block(8, 3 * markers[0], 12, 3).array().isNaN().all());
  EXPECT_TRUE(in_part.markers.block(20, 3 * markers[0], 20, 3).array().isFinite().all());
  EXPECT_EQ(left_out(recording, in_part), "");
  Recording mostly = held_out;  // neither part is known to be right
  mostly.markers.block(10, 3 * markers[0], 25, 3)
      .swap(mostly.markers.block(10, 3 * markers[1], 25, 3));
  EXPECT_EQ(left_out(recording, mostly), "");
  const std::vector<std::string> most = contradictions(recording, mostly);
  ASSERT_EQ(most.size(), 1u);
  EXPECT_NE(most[0].find("seem exchanged in 25 postures of trial check"), std::string::npos)
      << most[0];

  recording.q.col(2).array() += 2.0 * M_PI / 180.0;
  const std::vector<std::string> found = contradictions(recording, held_out);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NE(found[0].find(project_.tree.joints[2].name + ": its positions are off by"),
            std::string::npos)
      << found[0];

  // The joint is off from the held-out trials on.
  Recording since = held_out;
  since.q.col(2).tail(39).array() += 2.0 * M_PI / 180.0;
  const std::vector<std::string> seam =
      contradictions(as_trial("swing", TrialKind::kCalibration, 1), since);
  ASSERT_EQ(seam.size(), 1u);
  EXPECT_NE(seam[0].find("; it may as well be off by the opposite in swing"), std::string::npos)
      << seam[0];

  // This joint moves only few of the markers.
  Recording of_flange = as_trial("swing", TrialKind::kCalibration, 1);
  of_flange.q.col(6).array() += 1.5 * M_PI / 180.0;
  const std::vector<std::string> of_few = contradictions(of_flange, held_out);
  ASSERT_EQ(of_few.size(), 1u);
  EXPECT_NE(of_few[0].find("flange_joint: its positions are off by"), std::string::npos)
      << of_few[0];

  // Limbs that were calibrated one after the other are held out together.
  Recording together = held_out;
  together.trials[0].chains = {project_.chains[0].name, project_.chains[1].name};
  EXPECT_EQ(contradictions(recording, together).size(), 1u);
}

// Held-out trials may show fewer chains than any trial of the estimate. No fault of the log and no
// other place of the cluster explains that its markers shake.
TEST_F(TrialMistakes, AClusterThatShakesInHeldOutTrialsOfFewerChainsContradicts) {
  const ErrorModel model = MakeErrorModel(project_.tree, project_.markers, project_.placement);
  const BaseParameters base = FindBaseParameters(model, project_.identifiability);
  const Eigen::VectorXd truth = DrawErrors(model, base.kept, {{ParameterKind::kTheta, 0.01}}, 1);
  Recording recording = AsTrial(model, truth, "swing", TrialKind::kCalibration, 1);
  recording.trials[0].chains = {"arm", "wrist"};
  const ModelComparison comparison = CompareModels(
      Calibrate(model, recording, base, ModelKind::kGeometric, {}), model, recording, base, {});
  const auto contradictions = [&](const Recording& held_out) {
    return FindContradictions(project_, {model, base}, recording, held_out, comparison,
                              JudgeOnTrials(comparison, held_out, {}).table);
  };
  const auto shaken = [&](const std::string& cluster, double amplitude) {
    Recording held_out = AsTrial(model, truth, "check", TrialKind::kRandom, 2);
    for (const MarkerCluster& one : project_.clusters) {
      if (one.name != cluster) continue;
      for (const int m : one.markers) {
        for (int i = 0; i < held_out.posture_count(); ++i) {
          held_out.markers.block<1, 3>(i, 3 * m) +=
              amplitude * Eigen::RowVector3d(std::sin(1.7 * i), std::sin(2.9 * i + 1.0),
                                             std::sin(2.3 * i + 2.0));
        }
      }
    }
    return held_out;
  };
  EXPECT_TRUE(contradictions(shaken("TOOL", 0.0)).empty());
  for (const std::vector<std::string>& chains :
       {std::vector<std::string>{"arm"}, {"wrist"}, {"arm", "wrist"}}) {
    Recording held_out = shaken("TOOL", 0.012);
    held_out.trials[0].chains = chains;
    const std::vector<std::string> found = contradictions(held_out);
    ASSERT_EQ(found.size(), 1u) << chains.front();
    EXPECT_NE(found[0].find("held-out trials of " + chains.front()), std::string::npos) << found[0];
    EXPECT_NE(found[0].find("contradict those of the estimate"), std::string::npos) << found[0];
  }
  // A little less than ten times the error of the group, but more than that of its cluster.
  const std::vector<std::string> found = contradictions(shaken("FOREARM", 0.004));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NE(found[0].find("held-out trials of cluster FOREARM contradict"), std::string::npos)
      << found[0];
}

// Each of the two trials fits alone, because each leaves out one of the two markers as an outlier.
// So the estimate is good, but has both markers in one place.
TEST_F(TrialMistakes, LabelsExchangedInOneOfTwoTrialsAreNamedAndContradictHeldOutOnes) {
  const ErrorModel model = MakeErrorModel(project_.tree, project_.markers, project_.placement);
  const BaseParameters base = FindBaseParameters(model, project_.identifiability);
  const Eigen::VectorXd truth = DrawErrors(model, base.kept, {{ParameterKind::kTheta, 0.01}}, 1);
  const auto trial = [&](const std::string& name, TrialKind kind, std::uint64_t seed) {
    return AsTrial(model, truth, name, kind, seed);
  };
  const std::vector<int>& markers = project_.clusters.back().markers;
  Recording wrong = trial("wrong", TrialKind::kCalibration, 2);
  wrong.markers.middleCols<3>(3 * markers[0]).swap(wrong.markers.middleCols<3>(3 * markers[1]));
  Measurements measured;
  measured.calibration = JoinTrials(trial("swing", TrialKind::kCalibration, 1), wrong);
  const Recording& recording = measured.calibration;
  const ModelComparison comparison = CompareModels(
      Calibrate(model, recording, base, ModelKind::kGeometric, {}), model, recording, base, {});
  EXPECT_EQ(comparison.largest().outliers.size(), 80u);

  const std::vector<RecordingMistake> mistakes =
      FindRecordingMistakes(project_, 1, measured, recording, comparison.largest());
  ASSERT_EQ(mistakes.size(), 1u);
  EXPECT_EQ(mistakes[0].name, "labels:TOOL_1,TOOL_2");
  EXPECT_NE(mistakes[0].what.find("are exchanged in trial wrong"), std::string::npos)
      << mistakes[0].what;
  EXPECT_LT(mistakes[0].after, 1e-3);

  const Recording held_out = trial("check", TrialKind::kRandom, 3);
  const HeldOut judged = JudgeOnTrials(comparison, held_out, {});
  const std::vector<std::string> found =
      FindContradictions(project_, {model, base}, recording, held_out, comparison, judged.table);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NE(found[0].find("held-out trials of arm contradict those of the estimate"),
            std::string::npos)
      << found[0];
}

// A knock splits markers into two, of which the project knows only one.
TEST_F(TrialMistakes, AFaultBesideAKnockIsNamedByTheHeldOutTrial) {
  RecordedModel robot{MakeErrorModel(project_.tree, project_.markers, project_.placement), {}};
  robot.base = FindBaseParameters(robot.model, project_.identifiability);
  const Eigen::VectorXd truth =
      DrawErrors(robot.model, robot.base.kept, {{ParameterKind::kTheta, 0.01}}, 1);
  const auto as_trial = [&](const std::string& name, TrialKind kind, std::uint64_t seed) {
    return AsTrial(robot.model, truth, name, kind, seed);
  };
  Recording recording = as_trial("swing", TrialKind::kCalibration, 1);
  Recording held_out = as_trial("check", TrialKind::kRandom, 2);
  recording.q.col(2).array() += 2.0 * M_PI / 180.0;
  const MarkerCluster& cluster = project_.clusters.back();
  robot.knocks = {{.cluster = cluster.name, .markers = cluster.markers, .posture = 20}};
  SplitMarkers(robot.knocks, robot.model, recording);
  AddUnseenMarkers(robot.model, held_out);
  robot.base = FindBaseParameters(robot.model, project_.identifiability);
  const ModelComparison comparison =
      CompareModels(Calibrate(robot.model, recording, robot.base, ModelKind::kGeometric, {}),
                    robot.model, recording, robot.base, {});
  const ErrorTable judged = JudgeOnTrials(comparison, held_out, {}).table;
  const auto of_largest = JudgeLargestOnTrials(comparison, held_out, {}).table.mean_rmse_3d;
  ASSERT_EQ(of_largest.size(), 1u);
  EXPECT_EQ(of_largest.begin()->second, judged.mean_rmse_3d.at(of_largest.begin()->first));
  EXPECT_EQ(of_largest.begin()->first, comparison.largest_kind());
  const std::vector<std::string> found =
      FindContradictions(project_, robot, recording, held_out, comparison, judged);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NE(found[0].find(project_.tree.joints[2].name + ": its positions are off by"),
            std::string::npos)
      << found[0];
}

// A correction with which a robot explains the recording badly is not taken for the right one.
TEST_F(TrialMistakes, OfCorrectionsWithoutWhichNoRobotFitsTheBestIsNamed) {
  const ErrorModel model = MakeErrorModel(project_.tree, project_.markers, project_.placement);
  Recording recording = MakeSyntheticRecording(
      model, Eigen::VectorXd::Zero(model.parameter_count()), {.postures = 40});
  recording.trials = {{"swing", TrialKind::kCalibration, {project_.chains.front().name}}};
  recording.trial.assign(40, 0);
  recording.q.col(2) *= -1.0;
  recording.q.col(4).tail(15).setConstant(recording.q(25, 4));
  const auto error_of = [](const Recording& corrected) {
    return corrected.posture_count() < 40 ? 1e-4 : 0.05;
  };
  const std::vector<RecordingMistake> mistakes =
      FindMistakesBy(project_, recording, std::numeric_limits<double>::infinity(), error_of);
  ASSERT_FALSE(mistakes.empty());
  EXPECT_EQ(mistakes[0].name, "frozen:" + project_.tree.joints[4].name);
}

// In one trial the joint hardly moves, so that its markers tell nothing. Another trial was logged
// by a program with the right sign.
TEST_F(TrialMistakes, ASignIsUndoneInAllTrialsThatDoNotContradict) {
  const ErrorModel model = MakeErrorModel(project_.tree, project_.markers, project_.placement);
  const auto trial = [&](const std::string& name, std::uint64_t seed) {
    return AsTrial(model, Eigen::VectorXd::Zero(model.parameter_count()), name,
                   TrialKind::kCalibration, seed);
  };
  Recording still = trial("still", 2);
  still.q.col(2).setConstant(0.01);
  Measurements measured;
  measured.calibration = JoinTrials(JoinTrials(trial("swing", 1), still), trial("right", 3));
  const Eigen::MatrixXd q = measured.calibration.q;
  measured.calibration.q.col(2).head(80) *= -1.0;
  const std::string name = "sign:" + project_.tree.joints[2].name;
  EXPECT_EQ(AcceptMistakes(project_, {name}, measured).size(), 1u);
  EXPECT_EQ(measured.calibration.q, q);

  // If only a clock told the mistake, it is undone as well.
  measured.calibration = trial("still", 2);
  measured.calibration.q.col(2).setConstant(-0.01);
  measured.trials.resize(1);
  measured.trials[0].clock_without = {name};
  EXPECT_EQ(AcceptMistakes(project_, {name}, measured).size(), 1u);
  EXPECT_EQ(measured.calibration.q(0, 2), 0.01);
}

// Fits to thousands of moments take minutes. If a suspicion leaves much of the error in a few
// moments, it is not tried on all.
TEST_F(TrialMistakes, SuspicionsOfMotionsAreTriedByFewMomentsFirst) {
  const ErrorModel model = MakeErrorModel(project_.tree, project_.markers, project_.placement);
  Measurements measured;
  Recording& wrong = measured.calibration;
  wrong = MakeSyntheticRecording(model, Eigen::VectorXd::Zero(model.parameter_count()),
                                 {.postures = 500});
  wrong.trials = {{"swing", TrialKind::kSine, {project_.chains.front().name}}};
  wrong.trial.assign(500, 0);
  wrong.q.col(2) *= -1.0;
  int of_all = 0;
  double left_of_few = 0.0;
  const auto error_of = [&](const RecordedModel&, const Recording& recording) {
    of_all += recording.posture_count() > 120 ? 1 : 0;
    if (recording.q(0, 2) == wrong.q(0, 2)) return 0.05;
    return recording.posture_count() > 120 ? 1e-3 : left_of_few;
  };
  left_of_few = 0.04;
  EXPECT_TRUE(FindMistakesBy(project_, {}, measured, 0.05, error_of).empty());
  EXPECT_EQ(of_all, 0);
  left_of_few = 0.001;
  const std::vector<RecordingMistake> found =
      FindMistakesBy(project_, {}, measured, 0.05, error_of);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].name, "sign:" + project_.tree.joints[2].name);
  EXPECT_EQ(found[0].after, 1e-3);
  EXPECT_GT(of_all, 0);
}

// The cameras' export has one axis reversed.
TEST_F(TrialMistakes, MarkersOfTheOppositeHandAreNamed) {
  const ErrorModel model = MakeErrorModel(project_.tree, project_.markers, project_.placement);
  const Recording right = MakeSyntheticRecording(
      model, Eigen::VectorXd::Zero(model.parameter_count()), {.postures = 40});
  for (int axis = 0; axis < 3; ++axis) {
    Recording wrong = right;
    wrong.trials = {{"swing", TrialKind::kCalibration, {project_.chains.front().name}}};
    wrong.trial.assign(40, 0);
    for (int m = 0; m < wrong.marker_count(); ++m) wrong.markers.col(3 * m + axis) *= -1.0;
    const auto error_of = [&](const Recording& corrected) {
      return corrected.markers == Mirrored(wrong).markers ? 1e-4 : 0.05;
    };
    const std::vector<RecordingMistake> mistakes =
        FindMistakesBy(project_, wrong, std::numeric_limits<double>::infinity(), error_of);
    ASSERT_EQ(mistakes.size(), 1u);
    EXPECT_EQ(mistakes[0].what, kLeftHanded);
    EXPECT_EQ(DescribeMistake(mistakes[0]).find("--accept"), std::string::npos);
  }
  EXPECT_FALSE(LooksMirrored(model, right, 1e-3));
}

// A mistake that was named is undone by its name in all trials, and by no other name.
TEST_F(TrialMistakes, MistakesAreUndoneOnRequest) {
  const ErrorModel model = MakeErrorModel(project_.tree, project_.markers, project_.placement);
  const auto as_trial = [&](TrialKind kind, std::uint64_t seed) {
    return AsTrial(model, Eigen::VectorXd::Zero(model.parameter_count()), "swing", kind, seed);
  };
  Measurements measured;
  measured.calibration = as_trial(TrialKind::kCalibration, 1);
  measured.validation = as_trial(TrialKind::kRandom, 2);
  measured.calibration_truth.resize(40);
  measured.validation_truth.resize(40);
  const Eigen::MatrixXd q = measured.calibration.q, q_validation = measured.validation.q;
  const std::string joint = project_.tree.joints[2].name;
  measured.calibration.q.col(2) *= -1.0;
  measured.validation.q.col(2) *= -1.0;
  ExpectInputError([&] { AcceptMistakes(project_, {"frozen:" + joint}, measured); },
                   {"frozen:" + joint, "did you mean 'sign:" + joint});
  const auto error_of = [&](const Recording& corrected) {
    return (corrected.q - q).norm() < 1e-12 ? 0.1 : 0.9;
  };
  const std::vector<RecordingMistake> mistakes =
      FindMistakesBy(project_, measured.calibration, 1.0, error_of);
  ASSERT_EQ(mistakes.size(), 1u);
  EXPECT_EQ(mistakes[0].name, "sign:" + joint);
  EXPECT_EQ(mistakes[0].after, 0.1);
  std::vector<double> told;
  FindMistakesBy(project_, measured.calibration, 1.0, error_of, [&](const Recording&, double left) {
    told.push_back(left);
    return std::vector<LogSuspicion>();
  });
  EXPECT_EQ(told, (std::vector<double>{1.0, 0.1}));
  const std::vector<std::string> undone = AcceptMistakes(project_, {"sign:" + joint}, measured);
  EXPECT_EQ(undone.size(), 2u);
  EXPECT_EQ(measured.calibration.q, q);
  EXPECT_EQ(measured.validation.q, q_validation);
  ExpectInputError([&] { AcceptMistakes(project_, {"sign:" + joint}, measured); },
                   {"nothing in the recording points to it", "no mistake that has a name"});
  ExpectInputError([&] { AcceptMistakes(project_, {"bogus"}, measured); },
                   {"--accept bogus", "sign:JOINT, ", "offset:JOINT@TRIAL=SIZE", "scale=FACTOR"});

  measured.calibration.q.col(2).tail(15).setConstant(measured.calibration.q(25, 2));
  EXPECT_EQ(AcceptMistakes(project_, {"frozen:" + joint}, measured).size(), 1u);
  EXPECT_LT(measured.calibration.posture_count(), 30);
  EXPECT_EQ(measured.calibration_truth.size(), Size(measured.calibration.posture_count()));
}

}  // namespace
}  // namespace elastocal
