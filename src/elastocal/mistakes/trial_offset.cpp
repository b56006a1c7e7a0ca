// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/trial_offset.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "elastocal/calibration/prediction.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/thinned_motions.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/robot/coordinates.hpp"
#include "elastocal/robot/linkage.hpp"
#include "elastocal/screening/distance_parabola.hpp"
#include "elastocal/screening/measured_faults.hpp"
#include "elastocal/validation/deployment.hpp"
#include "elastocal/validation/transfer.hpp"

namespace elastocal {
namespace {

constexpr double kLeastTrialOffset = 0.25 * M_PI / 180.0, kLeastTrialShift = 1e-3;
constexpr double kLeftByOffset = 0.5;    // share of the squared distances
constexpr double kLeftOfFit = 0.5;       // share of the error of the fit
constexpr std::size_t kMostOffsets = 4;  // number of offsets that are corrected and fitted
constexpr int kMostOfMotions = 120;      // moments of held-out trials
constexpr int kNewtonSteps = 2;
constexpr double kLeastCurvature = 1e-12;  // share of the squared distances
constexpr int kFewestOfTrial = 3;          // postures
constexpr std::size_t kFewestTrials = 2;

/// Sums of numbers by posture, for each trial.
Eigen::VectorXd SumsByTrial(const Eigen::VectorXd& by_posture, const Recording& recording) {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(recording.trials.size()));
  for (int i = 0; i < recording.posture_count(); ++i) {
    sums[recording.trial[Size(i)]] += by_posture[i];
  }
  return sums;
}

void Move(const Eigen::VectorXd& by_trial, int coordinate, Recording& recording) {
  for (int i = 0; i < recording.posture_count(); ++i) {
    recording.q(i, coordinate) += by_trial[recording.trial[Size(i)]];
  }
}

struct TrialOffset {
  RecordingFault fault;
  double left = 0.0;  ///< sum of all squared distances with the offset corrected, m^2
};

/// Adds the offset of one joint in each trial. `by_posture` holds the squared distances as
/// recorded, m^2.
void AddOffsets(const CalibrationResult& result, const Recording& recording,
                const CalibrationOptions& options, Eigen::VectorXd by_posture, const Joint& joint,
                std::vector<TrialOffset>& found) {
  const Eigen::VectorXd given = SumsByTrial(by_posture, recording);
  const double enough = joint.type == JointType::kPrismatic ? kLeastTrialShift : kLeastTrialOffset;
  Recording moved = recording;
  Eigen::VectorXd by = Eigen::VectorXd::Zero(given.size());
  for (int step = 0; step < kNewtonSteps; ++step) {
    DistanceParabola parabola =
        ParabolaOf(result, moved, joint.coordinate, enough, by_posture, options);
    for (Eigen::VectorXd* squares : {&parabola.before, &parabola.at, &parabola.after}) {
      *squares = SumsByTrial(*squares, recording);
    }
    const Eigen::VectorXd change = enough * parabola.ToLeast(kLeastCurvature * given.sum());
    by += change;
    Move(change, joint.coordinate, moved);
    by_posture = SquaresByPosture(result, moved, options);
  }
  const Eigen::VectorXd at = SumsByTrial(by_posture, recording);
  for (Eigen::Index trial = 0; trial < given.size(); ++trial) {
    const double left = given.sum() - given[trial] + at[trial];
    const auto postures =
        std::count(recording.trial.begin(), recording.trial.end(), static_cast<int>(trial));
    if (!(std::abs(by[trial]) > enough) || !(left < kLeftByOffset * given.sum()) ||
        postures < kFewestOfTrial) {
      continue;
    }
    const auto first =
        std::find(recording.trial.begin(), recording.trial.end(), static_cast<int>(trial));
    found.push_back({{.kind = FaultKind::kJointOffset,
                      .coordinate = joint.coordinate,
                      .trial = static_cast<int>(trial),
                      .posture = static_cast<int>(first - recording.trial.begin()),
                      .size = -by[trial]},
                     left});
  }
}

/// The trials without an offset.
std::vector<TrialOffset> OfEachTrial(const Recording& recording) {
  std::vector<TrialOffset> offsets;
  for (int trial = 0; trial < std::ssize(recording.trials); ++trial) {
    const auto first = std::ranges::find(recording.trial, trial);
    if (std::ranges::count(recording.trial, trial) < kFewestOfTrial) continue;
    offsets.push_back({{.kind = FaultKind::kJointOffset,
                        .trial = trial,
                        .posture = static_cast<int>(first - recording.trial.begin())}});
  }
  return offsets;
}

/// Offsets of all joints in these trials, estimated beside the errors of the robot, which absorb a
/// part of each: the one that explains most first.
std::vector<RecordingFault> OffsetsBesideErrors(const CalibrationResult& result,
                                                const Recording& recording,
                                                const CalibrationOptions& options,
                                                const std::vector<TrialOffset>& offsets) {
  std::vector<RecordingFault> one_of_each;  // trial
  for (const TrialOffset& offset : offsets) {
    const bool known = std::ranges::any_of(
        one_of_each, [&](const RecordingFault& one) { return one.trial == offset.fault.trial; });
    if (!known) one_of_each.push_back(offset.fault);
  }
  if (one_of_each.empty()) return {};
  std::vector<RecordingFault> sought;
  for (const int joint : result.model.active_joints) {
    const Joint& of = result.model.tree.joints[Size(joint)];
    if (of.mimic || IsMovedByRods(result.model.tree, joint)) continue;
    for (RecordingFault fault : one_of_each) {
      fault.coordinate = of.coordinate;
      sought.push_back(fault);
    }
  }
  std::vector<RecordingFault> measured = MeasureFaults(sought, result, recording, options);
  std::erase_if(measured, [&](const RecordingFault& one) {
    const bool slides =
        JointOfCoordinate(result.model.tree, one.coordinate).type == JointType::kPrismatic;
    return !(std::abs(one.size) > LeastSize(one.kind, slides)) ||
           !(std::abs(one.size) < LargestSize(one.kind, slides)) || !IsCertain(one);
  });
  std::stable_sort(
      measured.begin(), measured.end(),
      [](const RecordingFault& a, const RecordingFault& b) { return a.share > b.share; });
  return measured;
}

}  // namespace

std::optional<double> ErrorOnHeldOut(const CalibrationResult& result, const BaseParameters& base,
                                     const Recording& held_out, const CalibrationOptions& options) {
  Recording few = WithThinnedMotions(held_out, kMostOfMotions);
  AddUnseenMarkers(result.model, few);
  std::map<std::string, double> errors;
  for (int i = 0; i < result.model.parameter_count(); ++i) {
    const Parameter& parameter = result.model.parameters[Size(i)];
    if (!IsExternal(parameter.kind)) errors[parameter.name] = result.delta[i];
  }
  try {
    return RefitTo(result.model, few, base, options, errors).metrics_all.rmse_3d;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

std::optional<RecordingFault> FindTrialOffset(const CalibrationResult& result,
                                              const BaseParameters& base,
                                              const Recording& recording,
                                              const CalibrationOptions& options,
                                              const Recording& held_out, OffsetTrials in) {
  if (recording.trials.size() < kFewestTrials) return std::nullopt;
  const RobotTree& tree = result.model.tree;
  const Eigen::VectorXd given = SquaresByPosture(result, recording, options);
  std::vector<TrialOffset> offsets;
  if (in == OffsetTrials::kAny) {
    offsets = OfEachTrial(recording);
  } else {
    for (const int k : result.model.active_joints) {
      const Joint& joint = tree.joints[Size(k)];
      if (joint.mimic || IsMovedByRods(tree, k)) continue;
      AddOffsets(result, recording, options, given, joint, offsets);
    }
  }
  std::stable_sort(offsets.begin(), offsets.end(),
                   [](const TrialOffset& a, const TrialOffset& b) { return a.left < b.left; });
  std::optional<double> predicted;  // error on the held-out trials with the fit as it is
  double least = kLeftOfFit * MarkerError(result, recording, options);
  std::optional<RecordingFault> found;
  const std::vector<RecordingFault> candidates =
      OffsetsBesideErrors(result, recording, options, offsets);
  for (std::size_t k = 0; k < std::min(kMostOffsets, candidates.size()); ++k) {
    const Recording without = WithoutFault(recording, candidates[k]);
    try {
      const CalibrationResult fit = Calibrate(result.model, without, base, result.kind, options);
      const double left = MarkerError(fit, without, options);
      if (!(left < least)) continue;
      if (held_out.posture_count() > 0) {
        if (!predicted) predicted = ErrorOnHeldOut(result, base, held_out, options);
        const auto without_it = ErrorOnHeldOut(fit, base, held_out, options);
        if (predicted && without_it && *without_it > kWorseBeyondChance * *predicted) continue;
      }
      least = left;
      found = candidates[k];
    } catch (const InputError&) {
      continue;
    }
  }
  return found;
}

}  // namespace elastocal
