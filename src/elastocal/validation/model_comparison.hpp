#pragma once

#include <array>
#include <cstdint>

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

struct CrossValidation {
  int folds = 0;
  ByModel<ErrorMetrics> metrics;  ///< over held-out observations
  int unconverged = 0;            ///< fits that did not converge
  int not_predicted =
      0;  ///< held-out observations without prediction: their marker is in no other fold
};

/// k-fold cross-validation by posture. Every posture is predicted once, by models calibrated
/// without it (waist and markers included). Only the observations that `comparison` kept are used.
/// `seed` deals the postures to the folds at random. Throws InputError for fewer than 2 folds, or
/// more folds than postures.
CrossValidation CrossValidate(const ModelComparison& comparison, const ErrorModel& model,
                              const Recording& recording, const BaseParameters& base,
                              const CalibrationOptions& options, int folds, std::uint64_t seed,
                              const Progress& progress = {});

}  // namespace elastocal
