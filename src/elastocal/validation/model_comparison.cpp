// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/model_comparison.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "elastocal/calibration/placing_markers.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/parallel.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/measurement/moments.hpp"
#include "elastocal/robot/moving_coordinates.hpp"

namespace elastocal {
namespace {

constexpr double kSamePosture = 0.02;  // largest difference of any joint, rad or m
constexpr double kStretch_s = 5.0;  // duration of the parts of a motion that are left out together

// Most neighbours that are compared with a posture, and most that are united with it: the others of
// many equal postures are united with these.
constexpr int kMostCompared = 5000, kMostUnited = 200;

/// The first posture of the unit; `before` is an earlier one of each posture's unit, or itself.
int FirstOfUnit(int posture, std::vector<int>& before) {
  while (before[posture] != posture) posture = before[posture] = before[before[posture]];
  return posture;
}

void Unite(int a, int b, std::vector<int>& before) {
  const int first = FirstOfUnit(a, before), other = FirstOfUnit(b, before);
  before[std::max(first, other)] = std::min(first, other);
}

/// Unites the moments of each stretch of a motion.
void UniteMoments(const Recording& recording, std::vector<int>& units) {
  const std::vector<int> motion = MotionOfPostures(recording);
  double begin = recording.time_s.size() > 0 ? recording.time_s[0] : 0.0;
  for (int i = 1; i < recording.posture_count(); ++i) {
    if (motion[i] < 0) continue;
    const double time = recording.time_s[i];
    const bool first = motion[i - 1] != motion[i];
    if (first || time - begin > kStretch_s) begin = time;
    if (begin < time) Unite(i - 1, i, units);
  }
}

/// Recording folder of each posture; empty for a posture table.
std::vector<int> SessionOfPosture(const Recording& recording) {
  std::vector<int> sessions;
  for (const int trial : recording.trial) sessions.push_back(recording.trials[trial].session);
  return sessions;
}

const char* NameOfUnits(FoldUnit unit) {
  switch (unit) {
    case FoldUnit::kTrial:
      return "trials";
    case FoldUnit::kSession:
      return "recording folders";
    default:
      return "different postures";
  }
}

/// Calls `united(a, b)` for nearly equal postures a and b: for all of them, or for so many that the
/// others are united with these.
template <typename United>
void ForEqualPostures(const Eigen::MatrixXd& q, United united) {
  // Nearly equal postures are neighbours in the order of the joint that moves furthest.
  const auto postures = static_cast<int>(q.rows());
  std::vector<int> order(Size(postures));
  std::iota(order.begin(), order.end(), 0);
  Eigen::Index furthest = 0;
  (q.colwise().maxCoeff() - q.colwise().minCoeff()).maxCoeff(&furthest);
  const Eigen::VectorXd positions = q.col(furthest);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return std::pair(positions[a], a) < std::pair(positions[b], b); });
  for (int k = 0; k < postures; ++k) {
    const int end = std::min(postures, k + 1 + kMostCompared);
    int count = 0;
    for (int l = k + 1; l < end && count < kMostUnited; ++l) {
      if (positions[order[l]] - positions[order[k]] > kSamePosture) break;
      const auto apart = (q.row(order[k]) - q.row(order[l])).cwiseAbs();
      if (apart.maxCoeff() > kSamePosture) continue;
      united(order[k], order[l]);
      ++count;
    }
  }
}

/// Unites nearly equal postures. Stretches of motions, which are united already, are united with
/// each other only where most moments of one have an equal in the other: a motion repeats itself.
/// Single moments do not count, because the last one of a stretch is nearly equal to the first one
/// of the next, and would unite all of them.
void UnitePostures(const Recording& recording, const Eigen::MatrixXd& q, std::vector<int>& units) {
  const std::vector<int> motion = MotionOfPostures(recording);
  std::vector<int> stretch(units.size(), -1);
  std::map<int, int> moments;  // by stretch
  for (std::size_t i = 0; i < units.size(); ++i) {
    if (motion[i] < 0) continue;
    stretch[i] = FirstOfUnit(static_cast<int>(i), units);
    ++moments[stretch[i]];
  }
  std::set<std::pair<int, int>> equals;  // moment, and another stretch in which it has an equal
  ForEqualPostures(q, [&](int a, int b) {
    if (stretch[Size(a)] < 0 || stretch[Size(b)] < 0) {
      Unite(a, b, units);
    } else if (stretch[Size(a)] != stretch[Size(b)]) {
      equals.insert({a, stretch[Size(b)]});
      equals.insert({b, stretch[Size(a)]});
    }
  });
  std::map<std::pair<int, int>, int> shared;
  for (const auto& [moment, other] : equals) ++shared[{stretch[Size(moment)], other}];
  for (const auto& [pair, count] : shared) {
    if (2 * count > moments[pair.first]) Unite(pair.first, pair.second, units);
  }
}

/// Unit of each posture: postures of one unit are left out together. Those of a table differ by the
/// given coordinates of q, or by all where none is given.
std::vector<int> UnitOfPosture(const Recording& recording, FoldUnit unit,
                               const std::vector<int>& coordinates) {
  if (unit == FoldUnit::kTrial) return recording.trial;
  if (unit == FoldUnit::kSession) return SessionOfPosture(recording);
  if (recording.posture_count() == 0) return {};
  std::vector<int> units(Size(recording.posture_count()));
  std::iota(units.begin(), units.end(), 0);
  UniteMoments(recording, units);
  if (coordinates.empty()) {
    UnitePostures(recording, recording.q, units);
  } else {
    UnitePostures(recording, recording.q(Eigen::all, coordinates), units);
  }
  for (int i = 0; i < recording.posture_count(); ++i) units[i] = FirstOfUnit(i, units);
  return units;
}

std::vector<int> DistinctUnits(const std::vector<int>& unit_of) {
  std::vector<int> units = unit_of;
  std::sort(units.begin(), units.end());
  units.erase(std::unique(units.begin(), units.end()), units.end());
  return units;
}

/// Distances of held-out observations from their predictions, by model.
struct FoldResult {
  std::vector<int> held_out;
  ByModel<Eigen::MatrixXd> distances;
  int unconverged = 0;
};

/// Sorts distances by the markers of the whole recording. Several markers of a fold may be one of
/// these (a knocked cluster), but only one is seen in a posture.
Eigen::MatrixXd InWholeRecording(const Eigen::MatrixXd& distances, const std::vector<int>& marker,
                                 int marker_count) {
  Eigen::MatrixXd whole = Eigen::MatrixXd::Constant(distances.rows(), marker_count, kNaN);
  for (Eigen::Index m = 0; m < distances.cols(); ++m) {
    auto column = whole.col(marker[static_cast<std::size_t>(m)]);
    column = distances.col(m).array().isFinite().select(distances.col(m), column);
  }
  return whole;
}

void PredictFold(const std::vector<ModelKind>& kinds, const FoldData& fold,
                 const CalibrationOptions& options, FootingBy by, int marker_count,
                 FoldResult& result) {
  // The largest model decides which observations are outliers; each model has its own weights.
  std::optional<Selection> selection;
  std::optional<CalibrationResult> largest;
  const std::vector<ModelKind> possible = ModelKinds(fold.model);
  const std::vector<ModelKind> largest_first(kinds.rbegin(), kinds.rend());
  for (ModelKind kind : largest_first) {
    Eigen::MatrixXd& distances = result.distances[static_cast<int>(kind)];
    if (std::find(possible.begin(), possible.end(), kind) == possible.end()) continue;
    const CalibrationResult estimate =
        kind == ModelKind::kRigid
            ? WithoutSprings(*largest, fold.model, fold.training, fold.base, options, *selection)
            : Calibrate(fold.model, fold.training, fold.base, kind, options,
                        selection ? &*selection : nullptr);
    if (!selection) {
      selection = Select(fold.model, fold.training, estimate.used, estimate.tied);
      largest = estimate;
    }
    result.unconverged += estimate.termination == Termination::kConverged ? 0 : 1;
    distances =
        Predict(estimate.model, estimate.delta, fold.held_out, options, &estimate.placement, by)
            .distances;
    // A marker without used observations has no estimated position.
    for (int m = 0; m < fold.model.marker_count(); ++m) {
      if (!estimate.used.col(m).any()) distances.col(m).setConstant(kNaN);
    }
    distances = InWholeRecording(distances, fold.marker, marker_count);
  }
  for (ModelKind kind : kinds) {  // kinds that the fold's model does not have
    Eigen::MatrixXd& distances = result.distances[static_cast<int>(kind)];
    if (distances.size() == 0) distances = result.distances[static_cast<int>(largest->kind)];
  }
}

/// Observations by which a prediction can be judged. On two feet, and where the root is free, the
/// markers that place the waist are left out, unless all markers place it.
ObservationMask Judged(const ErrorModel& model, const Recording& recording, FootingBy by) {
  ObservationMask judged = SeenMask(recording);
  if (!HasPoseByPosture(recording)) return judged;
  for (int i = 0; i < static_cast<int>(judged.rows()); ++i) {
    const bool on_two_feet =
        !recording.trials.empty() && recording.trials[recording.trial[i]].support.size() > 1;
    const bool free_root = HasFreeRoot(recording, i);
    if (!on_two_feet && (!free_root || by == FootingBy::kAllOfPosture)) continue;
    for (int m : PlacingMarkers(model, recording, i)) judged(i, m) = false;
  }
  return judged;
}

}  // namespace

int FoldsFor(const Recording& recording, int wanted, const std::vector<int>& coordinates) {
  const auto units =
      DistinctUnits(UnitOfPosture(recording, FoldUnit::kPosture, coordinates)).size();
  return std::min(wanted, static_cast<int>(units));
}

std::vector<int> DealFolds(const Recording& recording, const FoldOptions& options) {
  const std::vector<int> unit_of = UnitOfPosture(recording, options.unit, options.coordinates);
  std::vector<int> units = DistinctUnits(unit_of);
  const int count = static_cast<int>(units.size());
  if (count == 0) {
    throw InputError(recording.source + ": cross-validation by " + NameOfUnits(options.unit) +
                     " needs a recording of trials; this is a table of postures");
  }
  if (options.folds < 2 || options.folds > count) {
    const bool postures = options.unit == FoldUnit::kPosture;
    throw InputError("cross-validation needs 2 to " + std::to_string(count) +
                     " folds for as many " + NameOfUnits(options.unit) + ", not " +
                     std::to_string(options.folds) +
                     (postures ? " (equal are those that differ by less than 0.02 rad or m in all "
                                 "joints that move markers)"
                               : ""));
  }
  Random random(options.seed);
  for (int i = count - 1; i > 0; --i) std::swap(units[i], units[random.Index(i + 1)]);
  std::vector<int> fold;
  for (int unit : unit_of) {
    const auto at = std::find(units.begin(), units.end(), unit) - units.begin();
    fold.push_back(static_cast<int>(at) % options.folds);
  }
  return fold;
}

ModelComparison CompareModels(CalibrationResult largest, const ErrorModel& model,
                              const Recording& recording, const BaseParameters& base,
                              const CalibrationOptions& options, const Progress& progress) {
  ModelComparison comparison;
  comparison.kinds = ModelKinds(model);
  const auto total = static_cast<int>(comparison.kinds.size());
  comparison.results[static_cast<int>(comparison.largest_kind())] = std::move(largest);
  const Selection used =
      Select(model, recording, comparison.largest().used, comparison.largest().tied);
  int done = 0;
  for (ModelKind kind : comparison.kinds) {
    const auto k = static_cast<int>(kind);
    CalibrationResult& result = comparison.results[k];
    if (kind != comparison.largest_kind()) {
      result = kind == ModelKind::kRigid
                   ? WithoutSprings(comparison.largest(), model, recording, base, options, used)
                   : Calibrate(model, recording, base, kind, options, &used);
    }
    if (progress) progress(++done, total);
    comparison.predictions[k] = Predict(result.model, result.delta, recording, options);
    const Eigen::MatrixXd& distances = comparison.predictions[k].distances;
    comparison.metrics[k] = ComputeMetrics(distances, used.markers);
    comparison.metrics_all[k] = ComputeMetrics(distances, SeenMask(recording));
  }
  return comparison;
}

ModelComparison CompareModels(const ErrorModel& model, const Recording& recording,
                              const BaseParameters& base, const CalibrationOptions& options) {
  return CompareModels(Calibrate(model, recording, base, ModelKinds(model).back(), options), model,
                       recording, base, options);
}

CrossValidation CrossValidate(const ModelComparison& comparison, const ErrorModel& model,
                              const Recording& recording, const BaseParameters& base,
                              const CalibrationOptions& options, const FoldOptions& folds,
                              const Progress& progress) {
  CrossValidation validation =
      CrossValidate(comparison.kinds, model, recording, base, options, folds, progress);
  JudgeWithout(comparison.largest().used, comparison.kinds, validation);
  return validation;
}

void JudgeWithout(const ObservationMask& used, const std::vector<ModelKind>& kinds,
                  CrossValidation& validation) {
  for (ModelKind kind : kinds) {
    const auto k = static_cast<int>(kind);
    validation.metrics_without_outliers[k] = ComputeMetrics(validation.distances[k], used);
  }
}

CrossValidation CrossValidate(const std::vector<ModelKind>& kinds, const ErrorModel& model,
                              const Recording& recording, const BaseParameters& base,
                              const CalibrationOptions& options, const FoldOptions& folds,
                              const Progress& progress) {
  std::vector<int> marker(recording.marker_count());
  std::iota(marker.begin(), marker.end(), 0);
  const auto make = [&](const std::vector<int>& training, const std::vector<int>& held_out) {
    return FoldData{model, base, SelectPostures(recording, training),
                    SelectPostures(recording, held_out), marker};
  };
  return CrossValidate(kinds, model, recording, options, folds, make, progress);
}

CrossValidation CrossValidate(const std::vector<ModelKind>& kinds, const ErrorModel& model,
                              const Recording& recording, const CalibrationOptions& options,
                              const FoldOptions& folds, const MakeFold& make,
                              const Progress& progress) {
  FoldOptions deal = folds;
  deal.coordinates = MovingCoordinates(model);
  const std::vector<int> fold_of = DealFolds(recording, deal);
  std::vector<FoldResult> results(static_cast<std::size_t>(folds.folds));
  ForAll(
      results.size(), folds.threads,
      [&](std::size_t fold) {
        try {
          std::vector<int> training;
          for (int i = 0; i < recording.posture_count(); ++i) {
            const bool out = fold_of[i] == static_cast<int>(fold);
            (out ? results[fold].held_out : training).push_back(i);
          }
          PredictFold(kinds, make(training, results[fold].held_out), options, folds.by,
                      recording.marker_count(), results[fold]);
        } catch (const InputError& error) {
          throw InputError("cross-validation, without fold " + std::to_string(fold + 1) + " of " +
                           std::to_string(folds.folds) + ": " + error.what());
        }
      },
      progress);
  const ObservationMask judged = Judged(model, recording, folds.by);
  CrossValidation validation;
  validation.folds = folds.folds;
  validation.unit_of = UnitOfPosture(recording, deal.unit, deal.coordinates);
  for (const FoldResult& result : results) validation.unconverged += result.unconverged;
  for (ModelKind kind : kinds) {
    const auto k = static_cast<int>(kind);
    Eigen::MatrixXd& distances = validation.distances[k];
    distances.setConstant(judged.rows(), judged.cols(), kNaN);
    for (const FoldResult& result : results) {
      distances(result.held_out, Eigen::all) = result.distances[k];
    }
    for (Eigen::Index i = 0; i < distances.size(); ++i) {
      if (!judged.data()[i]) distances.data()[i] = kNaN;
    }
    validation.metrics[k] = ComputeMetrics(distances, judged);
  }
  validation.not_predicted = static_cast<int>(judged.count()) -
                             validation.metrics[static_cast<int>(kinds.back())].observations;
  return validation;
}

}  // namespace elastocal
