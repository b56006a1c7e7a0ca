// SPDX-License-Identifier: Apache-2.0
#include "elastocal/exports/held_out_gains.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/mistakes/read_accepting.hpp"
#include "elastocal/pipeline/earlier_calibration.hpp"
#include "elastocal/pipeline/known_places.hpp"
#include "elastocal/recorded/measurements.hpp"
#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/robot/moving_coordinates.hpp"
#include "elastocal/validation/model_comparison.hpp"
#include "elastocal/validation/transfer.hpp"

namespace elastocal {
namespace {

constexpr int kGainFolds = 5;
constexpr int kLeastGainPostures = 10;
/// A position that is further from the calibrated marker than this number of standard deviations
/// was not used by the calibration.
constexpr double kMeasuredThere = 5.0;

/// The stored estimate, judged by trials for validation.
HeldOutSplit StoredSplit(const RecordedModel& recorded, Measurements measured,
                         const StoredCalibration& stored, bool with_loads) {
  HeldOutSplit split;
  split.model = recorded.model;
  split.delta = ErrorsByName(recorded.model, stored.joint_errors, stored.externals);
  if (!with_loads && !stored.urdf_errors.empty()) {
    split.exported = ErrorsByName(recorded.model, AsInUrdf(stored).joint_errors, stored.externals);
  }
  split.training = std::move(measured.calibration);
  split.held_out = std::move(measured.validation);
  return split;
}

/// For each fold: the estimate without it, judged by it. `with_geometry`: what is exported is an
/// estimate of geometry alone.
std::vector<HeldOutSplit> FoldSplits(const RecordedModel& recorded, const Recording& recording,
                                     const std::vector<MarkerMeasurement>& places,
                                     const CalibrationOptions& options, bool with_geometry) {
  if (recording.posture_count() < kLeastGainPostures) {
    throw InputError(fmt::format("{}: {} postures; {} or more were expected to judge joints by",
                                 recording.source, recording.posture_count(), kLeastGainPostures));
  }
  FoldOptions folds{.folds = kGainFolds, .coordinates = MovingCoordinates(recorded.model)};
  if (recording.trials.size() >= kGainFolds) folds.unit = FoldUnit::kTrial;
  const std::vector<int> fold_of = DealFolds(recording, folds);
  std::vector<HeldOutSplit> splits;
  for (int fold = 0; fold < kGainFolds; ++fold) {
    std::vector<int> training, held_out;
    for (int i = 0; i < recording.posture_count(); ++i) {
      (fold_of[static_cast<std::size_t>(i)] == fold ? held_out : training).push_back(i);
    }
    HeldOutSplit split;
    split.training = SelectPostures(recording, training);
    split.held_out = SelectPostures(recording, held_out);
    split.same_trials = folds.unit == FoldUnit::kPosture;
    CalibrationOptions fold_options = options;
    std::vector<std::string> warnings;  // the calibration has given the same warnings
    CalibrationResult result =
        CalibrateWithPlaces(places, recorded, split.training, fold_options, warnings);
    if (with_geometry) {
      split.exported = Calibrate(recorded.model, split.training, recorded.base,
                                 ModelKind::kGeometric, fold_options)
                           .delta;
    }
    split.model = std::move(result.model);
    split.delta = std::move(result.delta);
    splits.push_back(std::move(split));
  }
  return splits;
}

/// Markers that are where they were measured, according to the calibration.
std::set<std::string> MeasuredMarkers(const std::vector<MarkerMeasurement>& places,
                                      const ErrorModel& model, const Eigen::VectorXd& estimate) {
  std::set<std::string> measured;
  for (const MarkerMeasurement& place : places) {
    const auto marker = std::ranges::find(model.markers, place.marker, &Marker::name);
    const int x = FindParameter(model.parameters, "marker." + place.marker + ".x");
    if (marker == model.markers.end() || x < 0) continue;
    const Eigen::Vector3d there = marker->p_link_marker + estimate.segment<3>(x);
    if ((there - place.p_link_marker).norm() < kMeasuredThere * place.sd) {
      measured.insert(place.marker);
    }
  }
  return measured;
}

}  // namespace

HeldOutGains FindHeldOutGains(const CalibratedRobot& robot, const GainOptions& options) {
  Project project = robot.project;
  CheckHasMarkers(project);
  project.elasticity = ElasticityOf(robot.calibration, project);
  const Assumptions told = RecordedAssumptions(robot);
  Measurements measured = ReadAccepting(project, RecordedRecordings(robot), told.accept).measured;
  const RecordedModel recorded = MakeRecordedModel(project, {}, measured);
  CheckApplies(robot.calibration, project, recorded.model);
  std::vector<std::string> warnings;
  const std::vector<MarkerMeasurement> places = OpenMarkerPlaces(
      told.marker_places, project, measured.calibration, recorded.knocks, warnings);
  GainOptions knowing = options;
  knowing.known_markers = MeasuredMarkers(
      places, recorded.model,
      ErrorsByName(recorded.model, robot.calibration.joint_errors, robot.calibration.externals));
  HeldOutGains gains;
  gains.least = options.least;
  const int held_out = measured.validation.posture_count();
  if (held_out > 0) {
    gains.judged_on = fmt::format("{} postures of {} held-out trials", held_out,
                                  measured.validation.trials.size());
    gains.study = StudyGains(
        {StoredSplit(recorded, std::move(measured), robot.calibration, options.with_loads)},
        project.calibration, knowing);
  } else {
    gains.judged_on =
        fmt::format("{} postures, each by an estimate without the fifth that it is in",
                    measured.calibration.posture_count());
    const bool with_geometry = !options.with_loads && !robot.calibration.urdf_errors.empty();
    gains.study = StudyGains(
        FoldSplits(recorded, measured.calibration, places, project.calibration, with_geometry),
        project.calibration, knowing);
  }
  return gains;
}

std::vector<std::string> DescribeGains(const HeldOutGains& gains) {
  const GainStudy& study = gains.study;
  std::vector<std::string> lines{
      fmt::format("Held-out error ({}; {} observations, {} left out as measured wrong): {:.3f} mm "
                  "uncalibrated, "
                  "{:.3f} mm with all joints, {:.3f} mm as exported",
                  gains.judged_on, study.observations, study.left_out, 1e3 * study.uncalibrated,
                  1e3 * study.all, 1e3 * study.kept)};
  for (const JointGain& joint : study.joints) {
    if (joint.kept) continue;
    if (joint.observations == 0) {
      lines.push_back(joint.owner + " is nominal: it moves no held-out observation");
      continue;
    }
    lines.push_back(fmt::format(
        "{} is nominal: on the {} observations that it moves it gains {:.4f} mm of {:.3f} mm, not "
        "more than {:g}",
        joint.owner, joint.observations, 1e3 * joint.gain, 1e3 * joint.rmse, 1e3 * gains.least));
  }
  return lines;
}

}  // namespace elastocal
