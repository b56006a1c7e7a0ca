// SPDX-License-Identifier: Apache-2.0
// Calibration with the library, through the header elastocal.hpp.

#include <fstream>
#include <set>

#include <gtest/gtest.h>

#include "elastocal/elastocal.hpp"
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

  /// Writes a calibration into a folder like the program.
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
  // Noise of 0.2 mm a coordinate is 0.35 mm in 3-D, of which the fit removes a part.
  EXPECT_LT(run.comparison.largest_metrics().rmse_3d, 0.35e-3);
  ASSERT_TRUE(run.urdf.has_value());
  EXPECT_NE(run.urdf->text.find("<robot"), std::string::npos);
}

// A folder has the files of one run. Those of a good run are removed when a bad run follows.
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

  project_.calibration.plausible_marker_sd = 1e-6;  // no real calibration is as good
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

// A shoulder with an offset of 5 mrad moves a hand at 0.5 m by 2.5 mm. The noise is 0.35 mm.
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

// If the URDF has the geometry of the full model, the file has no separate errors for it. The URDF
// still has no springs.
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

// The errors of the joints undo most of what its springs do, so that the nominal robot is good and
// the URDF, which has the former without the latter, is not.
TEST_F(Pipeline, AUrdfAloneThatIsWorseThanNominalIsNotBetter) {
  project_.elasticity.torsion = {"*"};
  const ErrorModel model = MakeProjectModel(project_, {});
  const BaseParameters base = FindBaseParameters(model, project_.identifiability);
  const auto bent = [&](const Eigen::VectorXd& delta) {
    Recording recording = MakeSyntheticRecording(model, delta, {.postures = 40, .marker_sd = 0.0});
    recording.markers = PredictedPositions(model, recording, delta, {});
    return recording;
  };
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(model.parameter_count());
  for (int i = 0; i < model.parameter_count(); ++i) {
    if (model.parameters[i].kind == ParameterKind::kTorsion) delta[i] = 2e-4;
  }
  const Eigen::VectorXd alike =
      Calibrate(model, bent(delta), base, ModelKind::kGeometric, project_.calibration).delta;
  for (int i = 0; i < model.parameter_count(); ++i) {
    if (!IsExternal(model.parameters[i].kind) && !IsElastic(model.parameters[i].kind)) {
      delta[i] = -alike[i];
    }
  }
  const Recording recording = bent(delta);
  WritePostureTable(table_, recording, project_.tree);
  const CalibrationResult result =
      Calibrate(model, recording, base, ModelKinds(model).back(), project_.calibration);
  std::ofstream(scratch_.path() / "calibration.yaml")
      << MakeCalibrationYaml(result, "there.csv", ZeroOffsets::kOrigin);
  const ValidationRun run = ValidateCalibration(project_, scratch_.path(), table_);
  EXPECT_TRUE(run.better());
  EXPECT_TRUE(run.urdf_worse());
  EXPECT_EQ(ValidationStatus(run), "not better");
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
