// SPDX-License-Identifier: Apache-2.0
// A robot whose root link has another pose in each posture (a mobile manipulator that cameras in
// the room see): identifiable parameters, recovery of the truth, and MuJoCo's robot from files.

#include <gtest/gtest.h>

#include "elastocal/calibration/placing_markers.hpp"
#include "elastocal/elastocal.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/planning/assess_postures.hpp"
#include "elastocal/planning/design_postures.hpp"
#include "elastocal/planning/simulate_experiment.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/tables/read_file.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/invented_arm.hpp"
#include "tests/scratch_folder.hpp"

namespace elastocal {
namespace {

using Kind = ParameterKind;

/// The recording with the robot at another place in each posture: up to two metres away, turned
/// about the vertical, and tilted by `tilt` [rad].
Recording Moved(Recording recording, double tilt, std::uint64_t seed) {
  Random random(seed);
  for (int i = 0; i < recording.posture_count(); ++i) {
    Transform T = RotZ(random.Uniform(-3.0, 3.0)) * RotX(random.Uniform(-tilt, tilt)) *
                  RotY(random.Uniform(-tilt, tilt));
    T.translation() = Eigen::Vector3d(random.Uniform(-2.0, 2.0), random.Uniform(-2.0, 2.0), 0.3);
    for (int m = 0; m < recording.marker_count(); ++m) {
      recording.markers.block<1, 3>(i, 3 * m) = (T * MarkerPosition(recording, i, m)).transpose();
    }
  }
  recording.free_root = true;
  return recording;
}

BaseParameters FreeBase(const ErrorModel& model) {
  return FindBaseParameters(model, {.root = RootPose::kFree});
}

bool IsRobots(const ErrorModel& model, int parameter) {
  return !IsExternal(model.parameters[parameter].kind);
}

/// Number of kept parameters of the robot itself.
int RobotsOwn(const ErrorModel& model, const BaseParameters& base) {
  return static_cast<int>(
      std::count_if(base.kept.begin(), base.kept.end(), [&](int i) { return IsRobots(model, i); }));
}

class FreeRoot : public InventedArm {};

// Three markers on the root replace the frame in which the arm was seen before. The same parameters
// of the robot are identifiable, and six fewer of the others (the pose of the root).
TEST_F(FreeRoot, MarkersOnTheRootTellAsMuchAsAHeldRoot) {
  const BaseParameters free = FreeBase(model_);
  EXPECT_EQ(free.geometric_count, base_.geometric_count - 6);
  EXPECT_EQ(free.geometric_count, free.theoretical_count);
  EXPECT_LT(free.largest_dropped, 1e-9);
  EXPECT_GT(free.smallest_kept, 1e-4);
}

// Joints before the first body with markers act like a motion of the root.
TEST_F(FreeRoot, JointsThatMoveAllMarkersTellNothing) {
  const ErrorModel model =
      SelectMarkers(model_, {"FOREARM_1", "FOREARM_2", "FOREARM_3", "TOOL_1", "TOOL_2", "TOOL_3"});
  const BaseParameters free = FreeBase(model);
  EXPECT_EQ(free.geometric_count, free.theoretical_count);
  for (int i : free.kept) {
    const int joint = model.parameters[i].joint;
    if (joint < 0) continue;
    const std::string& name = model.tree.joints[joint].name;
    EXPECT_NE(name, "turret_joint") << model.parameters[i].name;
    EXPECT_NE(name, "shoulder_joint") << model.parameters[i].name;
  }
  const ErrorModel hand = SelectMarkers(model_, {"TOOL_1", "TOOL_2", "TOOL_3"});
  EXPECT_EQ(RobotsOwn(hand, FreeBase(hand)), 0);
}

TEST_F(FreeRoot, NoiseFreeDataGiveBackTheTruth) {
  const Eigen::VectorXd truth = Truth(1, 5e-3);
  const auto record = [&](int postures, std::uint64_t seed) {
    return Moved(MakeSyntheticRecording(model_, truth,
                                        {.postures = postures, .marker_sd = 0.0, .seed = seed}),
                 0.5, seed + 10);
  };
  const CalibrationResult result =
      Calibrate(model_, record(60, 1), FreeBase(model_), ModelKind::kGeometric, {});
  EXPECT_EQ(result.termination, Termination::kConverged);
  EXPECT_TRUE(result.outliers.empty());
  int told = 0;
  for (int i = kWaistParameterCount; i < model_.parameter_count(); ++i) {
    EXPECT_NEAR(result.delta[i], truth[i], 1e-8 + 5.0 * result.sd[i]) << model_.parameters[i].name;
    if (result.sd[i] < 1e-6) ++told;
  }
  EXPECT_GE(told, 12);  // at least two for each of the arm's six joints
  // At a new place, the markers are where the model predicts them, relative to the root's markers.
  const Recording unseen = record(20, 2);
  const Prediction prediction = Predict(result.model, result.delta, unseen, {});
  EXPECT_LT(prediction.distances.maxCoeff(), 1e-8);
  const Eigen::VectorXd nominal = Eigen::VectorXd::Zero(model_.parameter_count());
  EXPECT_GT(Predict(result.model, nominal, unseen, {}).distances.maxCoeff(), 5e-3);
}

// Without markers on the root, those on the forearm place the arm.
TEST_F(FreeRoot, IsPlacedByTheBodyNearestToTheRoot) {
  const ErrorModel model =
      SelectMarkers(model_, {"TOOL_1", "TOOL_2", "TOOL_3", "FOREARM_1", "FOREARM_2", "FOREARM_3"});
  const Recording recording =
      Moved(MakeSyntheticRecording(model, Eigen::VectorXd::Zero(model.parameter_count()),
                                   {.postures = 3, .marker_sd = 0.0}),
            0.1, 1);
  EXPECT_EQ(PlacingMarkers(model, recording, 0), (std::vector<int>{3, 4, 5}));
  Recording hidden = recording;
  hidden.markers.block<1, 3>(0, 9).setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(PlacingMarkers(model, hidden, 0), (std::vector<int>{0, 1, 2}));
  EXPECT_LT(Predict(model, Eigen::VectorXd::Zero(model.parameter_count()), hidden, {})
                .distances.bottomRows(2)
                .maxCoeff(),
            1e-12);
}

/// The rests of a simulated folder as a posture table, with the robot at another place on a level
/// floor in each posture.
class MobileManipulator : public testing::Test {
 protected:
  void SetUp() override {
    // MuJoCo's arm has a held root link. Moved() puts it at another place in each posture.
    const Project held = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
    SimulationOptions options;
    options.experiment.motion.arm_postures = 60;
    options.experiment.motion.random_postures = 25;
    SimulateExperiment(held, options, scratch_.path() / "sim");
    measured_ = ReadMeasurements(held, {scratch_.path() / "sim"});
    project_ = held;
    project_.recording.free_root = true;
  }

  std::filesystem::path Table(const Recording& rests, std::uint64_t seed) const {
    Recording table = Moved(rests, 0.0, seed);
    table.time_s.resize(0);
    const auto file = scratch_.path() / ("table" + std::to_string(seed) + ".csv");
    WritePostureTable(file, table, project_.tree);
    return file;
  }

  ScratchFolder scratch_;
  Measurements measured_;
  Project project_;
};

TEST_F(MobileManipulator, OfMujocoIsCalibratedFromATable) {
  const auto table = Table(measured_.calibration, 1);
  const CalibrationRun run = CalibrateExperiment(project_, {table});
  EXPECT_EQ(RunStatus(run), "converged");
  EXPECT_TRUE(run.deployable());
  EXPECT_EQ(run.cross_validation.folds, 10);
  const auto error = [](const ByModel<ErrorMetrics>& metrics, ModelKind kind) {
    return metrics[static_cast<int>(kind)].rmse_3d;
  };
  const ModelKind best = run.comparison.largest_kind();
  const double folds = error(run.cross_validation.metrics, best);
  EXPECT_LT(5.0 * folds, error(run.cross_validation.metrics, ModelKind::kUncalibrated));
  EXPECT_LT(folds, 0.6e-3);  // 0.2 mm of camera noise alone

  // In other postures at other places, only the robot's place is fitted.
  const auto calibration = scratch_.path() / "out";
  OutputSet outputs;
  DeclareResults(calibration, CalibrationFileNames(project_), outputs);
  outputs.Prepare();
  CalibrationRun copy = run;
  SetResults(calibration, MakeCalibrationFiles(project_, copy), {"calibrate", "", "1", {}, {}},
             outputs);
  outputs.Publish();
  std::vector<int> resting;  // without the trial that moves without rests
  const Recording& held_out = measured_.validation;
  for (int i = 0; i < held_out.posture_count(); ++i) {
    if (held_out.trials[held_out.trial[i]].kind == TrialKind::kRandom) resting.push_back(i);
  }
  ASSERT_GE(resting.size(), 20u);
  const auto other = Table(SelectPostures(held_out, resting), 2);
  for (bool frozen : {false, true}) {
    const ValidationRun validation =
        ValidateCalibration(project_, calibration, other, {.frozen = frozen});
    EXPECT_TRUE(validation.better());
    EXPECT_LT(5.0 * validation.transfer.calibrated.metrics_all.rmse_3d,
              validation.transfer.uncalibrated.metrics_all.rmse_3d)
        << "frozen: " << frozen;
  }
}

TEST_F(MobileManipulator, WithMarkersOnOneBodyIsRefused) {
  Recording rests = measured_.calibration;
  std::vector<int> columns;
  std::vector<std::string> names;
  for (int m = 0; m < rests.marker_count(); ++m) {
    if (!rests.marker_names[m].starts_with("TOOL")) continue;
    names.push_back(rests.marker_names[m]);
    for (int axis = 0; axis < 3; ++axis) columns.push_back(3 * m + axis);
  }
  rests.marker_names = names;
  rests.markers = rests.markers(Eigen::all, columns).eval();
  const auto table = Table(rests, 3);
  ExpectInputError([&] { CalibrateExperiment(project_, {table}); },
                   {"table3.csv", "root is free", "one body"});
}

// Recording folders of a base that drives between the rests: the files of `simulate`, `calibrate`
// and held-out trials.
TEST(DrivingBase, IsCalibratedFromARecordingFolder) {
  ScratchFolder scratch;
  const Project held = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  Project free = held;
  free.recording.free_root = true;
  SimulationOptions options;
  options.experiment.motion.arm_postures = 30;
  options.matched = true;
  ExpectInputError([&] { PrepareSimulation(free, options); }, {"root is free", "matched"});
  options.matched = false;
  SimulateExperiment(free, options, scratch.path() / "sim");
  const CalibrationRun run = CalibrateExperiment(free, {scratch.path() / "sim"});
  EXPECT_TRUE(HasFreeRoot(run.recording));
  ASSERT_TRUE(run.held_out);
  EXPECT_TRUE(run.deployable());
  const std::map<ModelKind, double>& error = run.held_out->table.mean_rmse_3d;
  EXPECT_LT(5.0 * error.at(run.comparison.largest_kind()), error.at(ModelKind::kUncalibrated));
}

/// The arm's project with the section `design` and other sections.
Project ArmToDesign(const std::string& sections) {
  const auto file = SourceFile("tests/robots/arm6_project.yaml");
  std::string text = ReadFile(file);
  const std::string recording = "recording:\n";
  text.insert(text.find(recording) + recording.size(), sections);
  return ParseProject(text + "\ndesign:\n  chains: [{chain: arm}, {chain: wrist}]\n", file);
}

PostureDesign Designed(const Project& project) {
  PostureDesignOptions options;
  SetPostureCount(12, options.design);
  options.design.certify = false;
  return DesignPostures(project, options);
}

// Postures are chosen for what is estimated: those for a free root tell more of it than as many for
// a held root.
TEST(DesignWithAFreeRoot, ChoosesPosturesForIt) {
  const Project held = ArmToDesign(""), free = ArmToDesign("  root: free\n");
  const PostureDesign for_held = Designed(held), for_free = Designed(free);
  ASSERT_EQ(for_free.chains.size(), 2u);
  // 6 revolute joints, 1 prismatic joint and 10 markers. The wrist has 3 joints behind the markers
  // of the forearm, from which its markers are seen.
  EXPECT_EQ(for_free.chains[0].design.parameter_count, 4 * 6 + 2 * 1 + 3 * 10 - 6);
  EXPECT_EQ(for_free.chains[1].design.parameter_count, 4 * 3 + 3 * 7 - 6);
  PostureAssessmentOptions options;
  options.chains = {"arm"};
  options.assess.starts = 1;
  const auto o1 = [&](const PostureDesign& design) {
    return AssessPostures(free, design.postures(), options)[0].assessment.indices.o1;
  };
  EXPECT_NEAR(o1(for_free), for_free.chains[0].design.index, 1e-9);
  EXPECT_GT(o1(for_free), 1.005 * o1(for_held));
}

}  // namespace
}  // namespace elastocal
