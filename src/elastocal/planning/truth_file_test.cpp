// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/truth_file.hpp"

#include <gtest/gtest.h>

#include "elastocal/files/yaml_value.hpp"
#include "elastocal/io/joint_log.hpp"
#include "elastocal/io/waist_truth.hpp"
#include "elastocal/planning/simulate_experiment.hpp"
#include "elastocal/readers/qtm_tsv.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

/// The arm of the small humanoid in one trial of two postures.
class SimulatedFolder : public testing::Test {
 protected:
  SimulatedFolder() {
    options_.motion.head_postures = 2;
    options_.motion.leg_postures = options_.motion.random_postures = 1;
    options_.faults.dead_torque_sensor = "left_knee_pitch";
    options_.faults.lost_marker = "LHAND_1";
  }

  Project project_ = ReadProject(SourceFile("tests/robots/mini_humanoid_project.yaml"));
  VirtualExperimentOptions options_;
  ScratchFolder scratch_;
};

TEST_F(SimulatedFolder, IsWhatTheReadersOfARecordingTake) {
  options_.faults = {};
  const VirtualExperiment experiment = PrepareExperiment(DescribeRobot(project_), options_);
  const SimulatedTrial trial = RunTrial(experiment, 1);
  Experiment written;
  written.trials.push_back(FilesOfTrial(experiment.trials[1], scratch_.path()));
  WriteSimulatedTrial(written.trials[0], trial);
  WriteExperiment(scratch_.path(), written, project_);

  const Experiment read = ReadExperiment(scratch_.path(), project_);
  ASSERT_EQ(read.trials.size(), 1u);
  EXPECT_EQ(read.trials[0].name, "left_arm");
  EXPECT_EQ(read.trials[0].chains, experiment.trials[1].chains);
  EXPECT_EQ(read.trials[0].support, experiment.trials[1].support);
  const MarkerTrajectories markers = ReadQtmTsv(read.trials[0].markers);
  EXPECT_EQ(markers.rate_hz, 100.0);
  EXPECT_EQ(markers.names, trial.motion.marker_names);
  EXPECT_EQ(markers.frame_count(), trial.motion.frame_count());
  const JointLog log = ReadJointLog(read.trials[0].joints, project_);
  EXPECT_EQ(log.positions, trial.raw.joints.positions);
  const WaistTruth waist = ReadWaistTruth(read.trials[0].truth);
  EXPECT_EQ(static_cast<int>(waist.T_camera_waist.size()), markers.frame_count());
  EXPECT_EQ(waist.T_camera_waist[7].translation(), trial.motion.T_camera_waist[7].translation());
}

TEST_F(SimulatedFolder, TruthTellsWhatWasDrawn) {
  options_.faults.dead_torque_sensor.clear();
  const VirtualExperiment experiment = PrepareExperiment(DescribeRobot(project_), options_);
  const SimulatedTrial trial = RunTrial(experiment, 0);
  const YamlValue truth =
      YamlValue::Parse(FormatTruth(experiment, {0}, {trial.raw.truth}), "truth.yaml");
  EXPECT_EQ(truth.Get("seed").Integer(0, 9), 1);

  const int knee = FindJoint(project_.tree, "left_knee_pitch");
  const YamlValue joint = truth.Get("joints").Get("left_knee_pitch");
  EXPECT_NEAR(joint.Get("offset_deg").Number() * M_PI / 180.0, experiment.robot.offset[knee],
              1e-15);
  EXPECT_EQ(joint.Get("compliance_rad_per_nm").Number(), experiment.robot.compliance[knee]);
  // The description with the placement error applied must be the true placement.
  const auto vector = [](const YamlValue& list) {
    const auto items = list.Items();
    return Eigen::Vector3d(items[0].Number(), items[1].Number(), items[2].Number());
  };
  const Eigen::Vector3d turn = vector(joint.Get("turn_deg")) * M_PI / 180.0;
  const Transform rebuilt = project_.tree.joints[static_cast<std::size_t>(knee)].T_parent_child *
                            Eigen::Translation3d(1e-3 * vector(joint.Get("shift_mm"))) *
                            RotAxis(turn.normalized(), turn.norm());
  EXPECT_LT((rebuilt.matrix() -
             experiment.robot.tree.joints[static_cast<std::size_t>(knee)].T_parent_child.matrix())
                .cwiseAbs()
                .maxCoeff(),
            1e-12);
  EXPECT_EQ(truth.Get("legs").Get("left_leg").Get("stiffness").Items()[2].Number(),
            experiment.legs[0].compliance.stiffness[2]);
  const YamlValue head = truth.Get("trials").Get("head");
  EXPECT_EQ(head.Get("lag_s").Number(), trial.raw.truth.lag_s);
  ASSERT_EQ(head.Get("faults").Items().size(), 1u);
  EXPECT_EQ(head.Get("faults").Items()[0].Text(), "marker LHAND_1 lost in the second half");
}

TEST_F(SimulatedFolder, FaultsOfSensorsThatAreNotThereAreRefused) {
  // The small humanoid has no torque sensors.
  ExpectInputError([&] { PrepareExperiment(DescribeRobot(project_), options_); },
                   {"torque sensor", "left_knee_pitch"});
}

}  // namespace
}  // namespace elastocal
