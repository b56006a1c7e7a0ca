// SPDX-License-Identifier: Apache-2.0
// Predictions of a model: the pose of the waist relative to its foot, and the markers in a folder
// that the estimator's own model made.

#include "elastocal/calibration/prediction.hpp"

#include <gtest/gtest.h>

#include "elastocal/io/recording_folder.hpp"
#include "elastocal/planning/simulate_experiment.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/standing_humanoid.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

/// Largest distance between two estimates of the waist, over postures on one foot.
double LargestDistance(const Placement& a, const Placement& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.footing.size(); ++i) {
    if (a.footing[i] < 0) continue;
    const Eigen::Vector3d d = a.T_ref_waist[i].translation() - b.T_ref_waist[i].translation();
    largest = std::max(largest, d.norm());
  }
  return largest;
}

TEST(Prediction, FootMarkersAlonePlaceTheWaistWhateverTheOthersSay) {
  const StandingHumanoid robot(6);
  const Eigen::VectorXd truth = robot.DrawTruth(1);
  const Recording clean =
      robot.Record(truth, {.marker_sd = 0.0, .torque_sensors = robot.project.torque_sensors});
  Recording off = clean;
  const auto body = [&](int link) { return robot.project.tree.links[link].body; };
  for (int m = 0; m < off.marker_count(); ++m) {
    const int own = body(robot.model.markers[m].link);
    if (own == body(robot.model.legs[0].link) || own == body(robot.model.legs[1].link)) continue;
    off.markers.col(3 * m).array() += 5e-3;
  }
  const auto waists = [&](const Recording& recording, FootingBy by) {
    return Predict(robot.model, truth, recording, {}, nullptr, by).placement;
  };
  const Placement expected = waists(clean, FootingBy::kFootMarkers);
  // The shift tilts the first guess of the waist, and with it gravity, by a few mrad. The bending
  // by statics (of joints without torque sensors) then changes by micrometres.
  EXPECT_LT(LargestDistance(waists(off, FootingBy::kFootMarkers), expected), 2e-5);
  EXPECT_GT(LargestDistance(waists(off, FootingBy::kAllMarkers), expected), 1e-3);
  // Both fit data without noise. The nominal guess of the direction of gravity leaves a micrometre.
  EXPECT_LT(LargestDistance(waists(clean, FootingBy::kAllMarkers), expected), 3e-6);
}

/// The virtual experiment of the embedded humanoid with perfect sensors and few postures.
VirtualExperimentOptions PerfectSensors() {
  VirtualExperimentOptions options;
  const TruthOptions usual = options.truth;
  SwitchOffImperfections(options);
  options.truth.upper_geometry_scale = options.truth.leg_geometry_scale = 1.0;
  options.truth.upper_elasticity_scale = options.truth.leg_elasticity_scale = 1.0;
  options.truth.marker_sd = usual.marker_sd;
  options.motion.head_postures = options.motion.arm_postures = 2;
  options.motion.leg_postures = 3;
  options.motion.random_postures = options.motion.repetitions = 1;
  return options;
}

// The data go from the motion through files, filter, clock and samples to the prediction. TSV files
// round to a micrometre. Rounding of torques changes less than that through a leg's compliance.
TEST(Prediction, OfAPerfectMatchedFolderByItsTruthIsExact) {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  VirtualExperiment plan = PrepareExperiment(DescribeRobot(project), PerfectSensors());
  std::erase_if(plan.trials,
                [](const PlannedTrial& trial) { return trial.kind != TrialKind::kCalibration; });
  std::vector<Trial> trials;
  for (const PlannedTrial& planned : plan.trials) {
    Trial trial{planned.name, planned.kind, {}, planned.support};
    for (int chain : planned.chains) trial.chains.push_back(project.chains[chain].name);
    trials.push_back(trial);
  }
  const ErrorModel model = MakeProjectModel(project, trials);
  const MatchedExperiment matched =
      MatchExperiment(plan, model, FindBaseParameters(model, project.identifiability).kept);
  const ScratchFolder folder;
  Experiment written;
  for (std::size_t i = 0; i < plan.trials.size(); ++i) {
    written.trials.push_back(FilesOfTrial(plan.trials[i], folder.path()));
    WriteSimulatedTrial(written.trials.back(), RunMatchedTrial(matched, i));
  }
  WriteExperiment(folder.path(), written, project);

  const RecordingFolder recorded = ReadRecordingFolders({folder.path()}, project);
  ASSERT_GE(recorded.calibration.posture_count(), 12);
  const Prediction prediction =
      Predict(model, matched.truth, recorded.calibration, project.calibration);
  double largest = 0.0;
  for (double distance : prediction.distances.reshaped()) {
    if (!std::isnan(distance)) largest = std::max(largest, distance);
  }
  EXPECT_GT(largest, 0.0);
  EXPECT_LT(largest, 0.02e-3);
}

}  // namespace
}  // namespace elastocal
