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
  std::vector<ModelKind> kinds;  ///< those compared; entries of other kinds below have no meaning
  ByModel<CalibrationResult> results;
  ByModel<Prediction> predictions;  ///< of the same recording
  ByModel<ErrorMetrics>
      metrics;  ///< of the predictions, over the observations that the largest model kept
  ByModel<ErrorMetrics> metrics_all;  ///< over all observations, outliers included

  /// The largest model, with the most parameters: full, or geometric if nothing is elastic.
  ModelKind largest_kind() const { return kinds.back(); }
  const CalibrationResult& largest() const { return results[static_cast<int>(largest_kind())]; }
  const ErrorMetrics& largest_metrics() const { return metrics[static_cast<int>(largest_kind())]; }
};

/// Calibrates the other models beside `largest`, the result of the largest one. That one decides
/// which observations are outliers, so that all models are judged on the same data.
ModelComparison CompareModels(CalibrationResult largest, const ErrorModel& model,
                              const Recording& recording, const BaseParameters& base,
                              const CalibrationOptions& options, const Progress& progress = {});

/// Calibrates all models, the largest first.
ModelComparison CompareModels(const ErrorModel& model, const Recording& recording,
                              const BaseParameters& base, const CalibrationOptions& options);

/// What is left out together.
enum class FoldUnit {
  kPosture,  ///< postures, nearly equal ones and neighbours in a motion together
  kTrial,    ///< whole trials
  kSession,  ///< all trials of a recording folder
};

struct FoldOptions {
  int folds = 10;  ///< 2 to the number of units
  FoldUnit unit = FoldUnit::kPosture;
  std::uint64_t seed = 1;  ///< deals the units to the folds at random
  int threads = 1;
  FootingBy by = FootingBy::kAllMarkers;  ///< of the left-out postures
};

/// `wanted` folds, or as many as there are different postures. Those of a motion
/// (MotionOfPostures) are left out in stretches of five seconds.
int FoldsFor(const Recording& recording, int wanted);

/// The fold of each posture: a random permutation of the units is cut into equal parts. Throws
/// InputError for a number of folds that the recording does not allow.
std::vector<int> DealFolds(const Recording& recording, const FoldOptions& options);

struct CrossValidation {
  int folds = 0;
  /// Over all held-out observations that could be predicted. In a posture on two feet, the waist's
  /// own markers are not counted: they place it.
  ByModel<ErrorMetrics> metrics;
  /// Over those of them that the estimate from all postures does not call outliers (JudgeWithout).
  ByModel<ErrorMetrics> metrics_without_outliers;
  int unconverged = 0;  ///< fits that did not converge
  /// Held-out observations that no model could predict: their marker is in no other fold, the waist
  /// could not be placed, or their cluster was knocked between the other folds' postures around.
  int not_predicted = 0;
  ByModel<Eigen::MatrixXd> distances;  ///< postures x markers, m; NaN where not counted
  std::vector<int> unit_of;  ///< of each posture; those of a unit are much alike, or neighbours
};

/// What a fold is estimated from and judged on.
struct FoldData {
  ErrorModel model;  ///< as the training postures show the robot
  BaseParameters base;
  Recording training, held_out;  ///< with the markers of `model`
  /// By marker of `model`: which of the whole recording it is.
  std::vector<int> marker;
};

/// Decides on a fold, from its training postures alone, what is decided before an estimate. Both
/// lists are ascending indices of postures. Called from several threads.
using MakeFold =
    std::function<FoldData(const std::vector<int>& training, const std::vector<int>& held_out)>;

/// k-fold cross-validation. Every posture is predicted once, by models estimated without it; with
/// it everything is decided anew that an estimate decides (outliers, priors, noise, footings) and
/// that `make` does. A kind that a fold's model does not have (it is not elastic) is the largest
/// that it has. `model`: of the whole recording.
/// Throws InputError for a number of folds that the recording does not allow.
CrossValidation CrossValidate(const std::vector<ModelKind>& kinds, const ErrorModel& model,
                              const Recording& recording, const CalibrationOptions& options,
                              const FoldOptions& folds, const MakeFold& make,
                              const Progress& progress = {});

/// The same with one model for all folds.
CrossValidation CrossValidate(const std::vector<ModelKind>& kinds, const ErrorModel& model,
                              const Recording& recording, const BaseParameters& base,
                              const CalibrationOptions& options, const FoldOptions& folds,
                              const Progress& progress = {});

/// Fills `metrics_without_outliers`: over the observations in `used`.
void JudgeWithout(const ObservationMask& used, const std::vector<ModelKind>& kinds,
                  CrossValidation& validation);

/// With one model for the kinds of a comparison, whose largest model says what is an outlier.
CrossValidation CrossValidate(const ModelComparison& comparison, const ErrorModel& model,
                              const Recording& recording, const BaseParameters& base,
                              const CalibrationOptions& options, const FoldOptions& folds,
                              const Progress& progress = {});

}  // namespace elastocal
