// SPDX-License-Identifier: Apache-2.0
// Everything that runs on several threads: under the thread sanitizer (preset `threads`) this shows
// that they share nothing unguarded; in every build, that their number does not change the result.

#include <gtest/gtest.h>

#include "elastocal/files/output_files.hpp"
#include "elastocal/io/posture_file.hpp"
#include "elastocal/io/posture_table.hpp"
#include "elastocal/io/recording_folder.hpp"
#include "elastocal/pipeline/calibrate_experiment.hpp"
#include "elastocal/planning/plan_motion.hpp"
#include "elastocal/planning/simulate_experiment.hpp"
#include "elastocal/planning/simulation_settings.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

SimulationRun SimulateArm(const Project& project, int threads,
                          const std::filesystem::path& folder) {
  SimulationOptions options;
  for (const SimulationSetting& setting : SimulationSettings(options.experiment)) {
    if (setting.key == "arm_postures") ApplySetting(setting, "2", "test: ");
    if (setting.key == "random_postures") ApplySetting(setting, "1", "test: ");
  }
  options.threads = threads;
  return SimulateExperiment(project, options, folder);
}

TEST(Threads, TrialsAreSimulatedTogetherAndReadTogether) {
  const ScratchFolder scratch;
  const Project project = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  const SimulationRun together = SimulateArm(project, 3, scratch.path() / "three");
  SimulateArm(project, 1, scratch.path() / "one");
  ASSERT_GT(together.trials.size(), 2u);
  for (const TrialOutcome& trial : together.trials) {
    const std::string name = trial.name + ".tsv";
    EXPECT_EQ(ReadFile(scratch.path() / "three" / name), ReadFile(scratch.path() / "one" / name));
  }
  const RecordingFolder read = ReadRecordingFolders({scratch.path() / "three"}, project);
  EXPECT_EQ(read.trials.size(), together.trials.size());
}

TEST(Threads, ChainsArePlannedTogether) {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  const std::vector<ChainPostures> postures = ParsePostureFile(R"(
robot: talos
chains:
  - name: arm_left
    support: [left_sole_link, right_sole_link]
    postures: [{arm_left_1_joint: -0.4, arm_left_2_joint: 0.6, arm_left_4_joint: -1.2}]
  - name: arm_right
    support: [left_sole_link, right_sole_link]
    postures: [{arm_right_1_joint: 0.4, arm_right_2_joint: -0.6, arm_right_4_joint: -1.2}]
)",
                                                               "test", project);
  MotionPlanOptions options;
  options.threads = 2;
  const MotionPlan together = PlanMotion(project, postures, options);
  options.threads = 1;
  const MotionPlan in_turn = PlanMotion(project, postures, options);
  ASSERT_GT(together.whole.motion.q.rows(), 100);
  EXPECT_EQ(together.whole.motion.q, in_turn.whole.motion.q);
}

TEST(Threads, FoldsAreEstimatedTogether) {
  const ScratchFolder scratch;
  const Project project = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  const ErrorModel model = MakeProjectModel(project, {});
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(model.parameter_count());
  const std::filesystem::path table = scratch.path() / "table.csv";
  WritePostureTable(table, MakeSyntheticRecording(model, none, {.postures = 12}), project.tree);
  ExperimentOptions options{.folds = 3, .threads = 3};
  const CalibrationRun together = CalibrateExperiment(project, {table}, options);
  options.threads = 1;
  const CalibrationRun in_turn = CalibrateExperiment(project, {table}, options);
  ASSERT_EQ(together.cross_validation.folds, 3);
  const int kind = static_cast<int>(together.comparison.largest_kind());
  const Eigen::MatrixXd& distances = together.cross_validation.distances[kind];
  ASSERT_EQ(distances.rows(), 12);
  EXPECT_TRUE((distances.array() == in_turn.cross_validation.distances[kind].array() ||
               distances.array().isNaN())
                  .all());
}

}  // namespace
}  // namespace elastocal
