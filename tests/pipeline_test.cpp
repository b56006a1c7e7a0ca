// SPDX-License-Identifier: Apache-2.0
// Calibration through the library, as the header elastocal.hpp offers it.

#include <fstream>
#include <set>

#include <gtest/gtest.h>

#include "elastocal/elastocal.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/find_contradictions.hpp"
#include "elastocal/mistakes/log_alternatives.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

class Pipeline : public testing::Test {
 protected:
  void SetUp() override {
    const ErrorModel model = MakeErrorModel(project_.tree, project_.markers, project_.placement);
    const BaseParameters base = FindBaseParameters(model, project_.identifiability);
    recorded_ = MakeSyntheticRecording(
        model, DrawErrors(model, base.kept, {{ParameterKind::kTheta, 0.01}}, 1), {.postures = 30});
    WritePostureTable(table_, recorded_, project_.tree);
  }

  /// Calibrates into a folder as the program does.
  std::string Publish(const std::filesystem::path& folder, CalibrationRun& run) const {
    const std::vector<std::filesystem::path> inputs = InputFiles(project_, {table_});
    OutputSet outputs;
    outputs.Protect(inputs);
    DeclareResults(folder, CalibrationFileNames(project_), outputs);
    outputs.Prepare();
    const std::string no_page =
        SetResults(folder, MakeCalibrationFiles(project_, run),
                   {"calibrate", "", "1", {}, RecordInputs(inputs)}, outputs);
    outputs.Publish();
    return no_page;
  }

  ScratchFolder scratch_;
  Project project_ = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  std::filesystem::path table_ = scratch_.path() / "recording.csv";
  Recording recorded_;
};

std::set<std::string> Names(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.insert(entry.path().filename().string());
  }
  return names;
}

TEST_F(Pipeline, CalibratesAndTellsOfItsSteps) {
  std::vector<std::string> steps;
  const CalibrationRun run = CalibrateExperiment(
      project_, {table_}, {.folds = 3, .progress = [&](const std::string& step, int done, int all) {
                             if (done == all) steps.push_back(step);
                           }});
  EXPECT_EQ(steps, (std::vector<std::string>{"fit", "cross-validation"}));
  EXPECT_TRUE(run.deployable());
  EXPECT_EQ(RunStatus(run), "converged");
  EXPECT_EQ(run.recording.posture_count(), 30);
  EXPECT_EQ(run.cross_validation.folds, 3);
  // Noise of 0.2 mm a coordinate is 0.35 mm in 3-D; the fit takes a part of it away.
  EXPECT_LT(run.comparison.largest_metrics().rmse_3d, 0.35e-3);
  ASSERT_TRUE(run.urdf.has_value());
  EXPECT_NE(run.urdf->text.find("<robot"), std::string::npos);
}

// A folder holds the files of one run: those of a good run go when a bad one follows.
TEST_F(Pipeline, ARunThatIsNotDeployableTakesTheEarlierFilesAway) {
  const std::filesystem::path folder = scratch_.path() / "out";
  CalibrationRun run = CalibrateExperiment(project_, {table_}, {.folds = 3});
  const std::string no_page = Publish(folder, run);
  const std::vector<std::string> all = CalibrationFileNames(project_);
  std::set<std::string> expected(all.begin(), all.end());
  expected.insert({"runs.json", "SHA256SUMS"});
  if (no_page.empty()) expected.insert("report.html");
  EXPECT_EQ(Names(folder), expected);
  EXPECT_EQ(CompareCalibrations(folder, folder).comparison.changed, false);

  project_.calibration.plausible_marker_sd = 1e-6;  // nothing real is as good
  run = CalibrateExperiment(project_, {table_}, {.folds = 3});
  EXPECT_FALSE(run.deployable());
  EXPECT_FALSE(run.urdf.has_value());
  Publish(folder, run);
  for (const char* name :
       {"arm6_calibrated.urdf", "calibration.yaml", "offsets.xacro", "covariance.csv"}) {
    expected.erase(name);
  }
  EXPECT_EQ(Names(folder), expected);
  ExpectInputError([&] { CompareCalibrations(folder, folder); }, {"no calibration.yaml"});
}

TEST_F(Pipeline, ACalibrationIsValidatedOnAnotherRecording) {
  const std::filesystem::path folder = scratch_.path() / "out";
  CalibrationRun run = CalibrateExperiment(project_, {table_}, {.folds = 3});
  Publish(folder, run);
  const ValidationRun validation =
      ValidateCalibration(project_, folder / "calibration.yaml", table_);
  EXPECT_EQ(ValidationStatus(validation), "better");
  EXPECT_TRUE(validation.own_recording);
  EXPECT_LT(validation.transfer.calibrated.metrics.rmse_3d,
            0.5 * validation.transfer.uncalibrated.metrics.rmse_3d);
  ExpectInputError(
      [&] { ValidateCalibration(project_, folder, table_, {.accept = {"sign:arm_2_joint"}}); },
      {"sign:arm_2_joint", "nothing in the recording points to it"});
}

// A shoulder that is off by 5 mrad moves a hand at 0.5 m by 2.5 mm; the noise is 0.35 mm.
TEST_F(Pipeline, AValidationSaysWhetherTheErrorsAreThosePredicted) {
  const std::filesystem::path folder = scratch_.path() / "out";
  CalibrationRun run = CalibrateExperiment(project_, {table_}, {.folds = 3});
  Publish(folder, run);
  const auto validate = [&](double turned) {
    Recording other = recorded_;
    other.q.col(1).array() += turned;
    const std::filesystem::path file = scratch_.path() / "other.csv";
    WritePostureTable(file, other, project_.tree);
    return ValidateCalibration(project_, folder, file);
  };
  const ValidationRun same = validate(1e-9);
  EXPECT_FALSE(same.own_recording);
  EXPECT_NEAR(same.predicted, run.deployment.urdf, 1e-9);
  EXPECT_TRUE(same.as_predicted());
  EXPECT_TRUE(same.warnings.empty()) << same.warnings.front();
  const ValidationRun moved = validate(0.005);
  EXPECT_TRUE(moved.better());
  EXPECT_FALSE(moved.as_predicted());
  ASSERT_FALSE(moved.warnings.empty());
  EXPECT_NE(moved.warnings.back().find("its calibration predicted"), std::string::npos);
}

// A file whose URDF has the geometry of the full model says no other errors for it; the URDF has no
// springs all the same.
TEST_F(Pipeline, TheUrdfIsValidatedWithoutSprings) {
  project_.elasticity.torsion = {"*"};
  const ErrorModel model = MakeProjectModel(project_, {});
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(model.parameter_count());
  for (int i = 0; i < model.parameter_count(); ++i) {
    if (model.parameters[i].kind == ParameterKind::kTheta) delta[i] = 0.01;
    if (model.parameters[i].kind == ParameterKind::kTorsion) delta[i] = 1e-4;
  }
  Recording bent = MakeSyntheticRecording(model, delta, {.postures = 40, .marker_sd = 0.0});
  bent.markers = PredictedPositions(model, bent, delta, {});
  WritePostureTable(table_, bent, project_.tree);
  const CalibrationResult result =
      Calibrate(model, bent, FindBaseParameters(model, project_.identifiability),
                ModelKinds(model).back(), project_.calibration);
  std::ofstream(scratch_.path() / "calibration.yaml")
      << MakeCalibrationYaml(result, "there.csv", ZeroOffsets::kOrigin);
  const ValidationRun run = ValidateCalibration(project_, scratch_.path(), table_);
  ASSERT_TRUE(run.urdf);
  EXPECT_LT(run.transfer.calibrated.metrics.rmse_3d, 0.02e-3);
  EXPECT_GT(run.urdf->metrics.rmse_3d, 5.0 * run.transfer.calibrated.metrics.rmse_3d);
}

// The only trial of the estimate cannot show that one of its joints is off: the fit takes that for
// an error of the robot. The held-out trial shows it.
TEST_F(Pipeline, AFaultOfTheOnlyTrialIsNamedByTheHeldOutOne) {
  const ErrorModel model = MakeErrorModel(project_.tree, project_.markers, project_.placement);
  const BaseParameters base = FindBaseParameters(model, project_.identifiability);
  const Eigen::VectorXd truth = DrawErrors(model, base.kept, {{ParameterKind::kTheta, 0.01}}, 1);
  const auto as_trial = [&](const std::string& name, TrialKind kind, std::uint64_t seed) {
    Recording recording = MakeSyntheticRecording(model, truth, {.postures = 40, .seed = seed});
    recording.trials = {{name, kind, {project_.chains.front().name}}};
    recording.trial.assign(40, 0);
    return recording;
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
  Recording mostly = held_out;  // who knows which part is right?
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

  // From the held-out trials on.
  Recording since = held_out;
  since.q.col(2).tail(39).array() += 2.0 * M_PI / 180.0;
  const std::vector<std::string> seam =
      contradictions(as_trial("swing", TrialKind::kCalibration, 1), since);
  ASSERT_EQ(seam.size(), 1u);
  EXPECT_NE(seam[0].find("; it may as well be off by the opposite in swing"), std::string::npos)
      << seam[0];

  // A joint that moves few of the markers.
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

// Markers that a knock made two are unknown to the project.
TEST_F(Pipeline, AFaultBesideAKnockIsNamedByTheHeldOutTrial) {
  RecordedModel robot{MakeErrorModel(project_.tree, project_.markers, project_.placement), {}};
  robot.base = FindBaseParameters(robot.model, project_.identifiability);
  const Eigen::VectorXd truth =
      DrawErrors(robot.model, robot.base.kept, {{ParameterKind::kTheta, 0.01}}, 1);
  const auto as_trial = [&](const std::string& name, TrialKind kind, std::uint64_t seed) {
    Recording trial = MakeSyntheticRecording(robot.model, truth, {.postures = 40, .seed = seed});
    trial.trials = {{name, kind, {project_.chains.front().name}}};
    trial.trial.assign(40, 0);
    return trial;
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

// A correction that lets a robot explain the recording, if badly, is not taken for the right one.
TEST_F(Pipeline, OfCorrectionsWithoutWhichNoRobotFitsTheBestIsNamed) {
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

// In one trial the joint hardly moves, so that its markers tell nothing; another one was logged by
// a program that had it right.
TEST_F(Pipeline, ASignIsUndoneInAllTrialsThatDoNotContradict) {
  const ErrorModel model = MakeErrorModel(project_.tree, project_.markers, project_.placement);
  const auto trial = [&](const std::string& name, std::uint64_t seed) {
    Recording recording = MakeSyntheticRecording(
        model, Eigen::VectorXd::Zero(model.parameter_count()), {.postures = 40, .seed = seed});
    recording.trials = {{name, TrialKind::kCalibration, {project_.chains.front().name}}};
    recording.trial.assign(40, 0);
    return recording;
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

  // Where only a clock told it, it is undone as well.
  measured.calibration = trial("still", 2);
  measured.calibration.q.col(2).setConstant(-0.01);
  measured.trials.resize(1);
  measured.trials[0].clock_without = {name};
  EXPECT_EQ(AcceptMistakes(project_, {name}, measured).size(), 1u);
  EXPECT_EQ(measured.calibration.q(0, 2), 0.01);
}

// Cameras whose export has one axis the other way.
TEST_F(Pipeline, MarkersOfTheOppositeHandAreNamed) {
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

// A mistake that was named is undone by its name, in all trials, and by no other.
TEST_F(Pipeline, MistakesAreUndoneOnRequest) {
  const ErrorModel model = MakeErrorModel(project_.tree, project_.markers, project_.placement);
  const auto as_trial = [&](TrialKind kind, std::uint64_t seed) {
    Recording recording = MakeSyntheticRecording(
        model, Eigen::VectorXd::Zero(model.parameter_count()), {.postures = 40, .seed = seed});
    recording.trials = {{"swing", kind, {project_.chains.front().name}}};
    recording.trial.assign(40, 0);
    return recording;
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

TEST_F(Pipeline, InspectsEveryChainAndTheWhole) {
  const RobotInspection inspection = InspectRobot(project_);
  ASSERT_EQ(inspection.chains.size(), 3u);
  EXPECT_EQ(inspection.chains.back().name, "(all markers)");
  EXPECT_EQ(inspection.placements.size(), project_.tree.joints.size());
  for (const ChainInspection& chain : inspection.chains) {
    EXPECT_EQ(chain.base.geometric_count, chain.base.theoretical_count) << chain.name;
  }
  ExpectInputError([&] { InspectRobot(project_, {.hold = {{"elbow.thet"}}}); }, {"elbow.thet"});
}

}  // namespace
}  // namespace elastocal
