// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/calibration/prediction.hpp"
#include "elastocal/math/progress.hpp"
#include "elastocal/validation/metrics.hpp"

namespace elastocal {

/// One value for each ModelKind.
template <typename T>
using ByModel = std::array<T, kModelKindCount>;

/// The models of paper section 6.1.4 on one recording.
struct ModelComparison {
  std::vector<ModelKind> kinds;  ///< models compared; entries of other kinds have no meaning
  ByModel<CalibrationResult> results;
  ByModel<Prediction> predictions;  ///< predictions of the same recording
  ByModel<ErrorMetrics>
      metrics;  ///< of the predictions, over the observations that the largest model kept
  ByModel<ErrorMetrics> metrics_all;  ///< over all observations, outliers included

  /// The largest model: full, or geometric if nothing is elastic.
  ModelKind largest_kind() const { return kinds.back(); }
  const CalibrationResult& largest() const { return results[static_cast<int>(largest_kind())]; }
  const ErrorMetrics& largest_metrics() const { return metrics[static_cast<int>(largest_kind())]; }
};

/// Calibrates the other models beside `largest`, the result of the largest one, which decides which
/// observations are outliers. All models are thus judged on the same data.
ModelComparison CompareModels(CalibrationResult largest, const ErrorModel& model,
                              const Recording& recording, const BaseParameters& base,
                              const CalibrationOptions& options, const Progress& progress = {});

/// Calibrates all models, the largest first.
ModelComparison CompareModels(const ErrorModel& model, const Recording& recording,
                              const BaseParameters& base, const CalibrationOptions& options);

/// What one fold leaves out as a whole.
enum class FoldUnit {
  kPosture,  ///< postures; nearly equal ones, and neighbours in a motion, together
  kTrial,    ///< whole trials
  kSession,  ///< all trials of a recording folder
};

/// How the postures are divided into folds.
struct FoldOptions {
  int folds = 10;  ///< 2 to the number of units
  FoldUnit unit = FoldUnit::kPosture;
  std::uint64_t seed = 1;  ///< seed by which the units are distributed to the folds
  int threads = 1;
  FootingBy by = FootingBy::kAllMarkers;  ///< markers that place the feet in the held-out postures
  /// Coordinates of q by which postures differ, for DealFolds; empty: all. CrossValidate takes
  /// those of its model (MovingCoordinates).
  std::vector<int> coordinates = {};
};

/// The number of folds: `wanted`, or the number of different postures if that is smaller: of those
/// that differ by 0.02 rad or m in one of the coordinates (MovingCoordinates; none: all). Moments
/// of a motion (MotionOfPostures) are left out in stretches of five seconds.
int FoldsFor(const Recording& recording, int wanted, const std::vector<int>& coordinates = {});

/// The fold of each posture: a random permutation of the units is cut into parts of equal size.
/// Throws InputError for a number of folds that the recording does not allow.
std::vector<int> DealFolds(const Recording& recording, const FoldOptions& options);

/// Result of a cross-validation.
struct CrossValidation {
  int folds = 0;
  /// Errors over all held-out observations that could be predicted. In a posture on two feet, the
  /// waist's own markers do not count, because they place it.
  ByModel<ErrorMetrics> metrics;
  /// Errors over those of them that are no outliers of the estimate from all postures
  /// (JudgeWithout).
  ByModel<ErrorMetrics> metrics_without_outliers;
  int unconverged = 0;  ///< number of fits that did not converge
  /// Number of held-out observations that no model could predict: their marker is in no other fold,
  /// the waist could not be placed, or their cluster was knocked between the postures of the other
  /// folds before and after.
  int not_predicted = 0;
  ByModel<Eigen::MatrixXd> distances;  ///< by model, postures x markers, m; NaN where not counted
  /// Unit of each posture; postures of a unit are much alike, or neighbours.
  std::vector<int> unit_of;
};

/// Data from which a fold is estimated and on which it is judged.
struct FoldData {
  ErrorModel model;  ///< model of the robot by the training postures
  BaseParameters base;
  Recording training, held_out;  ///< with the markers of `model`
  /// For each marker of `model`: its index in the whole recording.
  std::vector<int> marker;
};

/// Makes the data of a fold. It decides from the training postures alone all that is decided before
/// an estimate. Both lists are indices of postures, ascending. Called from several threads.
using MakeFold =
    std::function<FoldData(const std::vector<int>& training, const std::vector<int>& held_out)>;

/// k-fold cross-validation. Every posture is predicted once, by models that are estimated without
/// it. Everything that an estimate decides is decided anew in each fold (outliers, priors, noise,
/// footings), and so is what `make` decides. If a fold's model does not have a kind (it is not
/// elastic), its largest kind takes that place. `model` is that of the whole recording. Throws
/// InputError for a number of folds that the recording does not allow.
CrossValidation CrossValidate(const std::vector<ModelKind>& kinds, const ErrorModel& model,
                              const Recording& recording, const CalibrationOptions& options,
                              const FoldOptions& folds, const MakeFold& make,
                              const Progress& progress = {});

/// As above, with one model for all folds.
CrossValidation CrossValidate(const std::vector<ModelKind>& kinds, const ErrorModel& model,
                              const Recording& recording, const BaseParameters& base,
                              const CalibrationOptions& options, const FoldOptions& folds,
                              const Progress& progress = {});

/// Fills `metrics_without_outliers`: errors over the observations in `used`.
void JudgeWithout(const ObservationMask& used, const std::vector<ModelKind>& kinds,
                  CrossValidation& validation);

/// As above, for the kinds of a comparison. Its largest model decides which observations are
/// outliers.
CrossValidation CrossValidate(const ModelComparison& comparison, const ErrorModel& model,
                              const Recording& recording, const BaseParameters& base,
                              const CalibrationOptions& options, const FoldOptions& folds,
                              const Progress& progress = {});

}  // namespace elastocal
