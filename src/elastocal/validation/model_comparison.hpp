#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/calibration/prediction.hpp"
#include "elastocal/validation/metrics.hpp"

namespace elastocal {

/// Something for each ModelKind.
template <typename T>
using ByModel = std::array<T, kModelKindCount>;

/// The models of paper section 6.1.4 on one recording.
struct ModelComparison {
  std::vector<ModelKind> kinds;  ///< those compared; of others the entries below mean nothing
  ByModel<CalibrationResult> results;
  ByModel<Prediction> predictions;    ///< of the same recording
  ByModel<ErrorMetrics> metrics;      ///< of these, over the observations that the best model kept
  ByModel<ErrorMetrics> metrics_all;  ///< over all, outliers included

  /// The model with most parameters: full, or geometric where nothing is elastic.
  ModelKind best_kind() const { return kinds.back(); }
  const CalibrationResult& best() const { return results[static_cast<int>(best_kind())]; }
};

/// Called with the number of finished steps and of all steps; may be empty.
using Progress = std::function<void(int done, int total)>;

/// Calibrates all models. The one with most parameters comes first and decides which observations
/// are outliers, so that all are judged on the same data.
ModelComparison CompareModels(const ErrorModel& model, const Recording& recording,
                              const BaseParameters& base, const CalibrationOptions& options);

struct CrossValidation {
  int folds = 0;
  ByModel<ErrorMetrics> metrics;  ///< of held-out observations
  int unconverged = 0;            ///< fits that did not converge
  int not_predicted = 0;  ///< held-out observations left out: the marker was in no other fold
};

/// k-fold cross-validation by posture: every posture is predicted once by models calibrated without
/// it (waist and markers included), over the observations that `comparison` kept. Postures are
/// dealt to the folds at random, by `seed`. Throws InputError when folds are fewer than 2 or more
/// than the postures.
CrossValidation CrossValidate(const ModelComparison& comparison, const ErrorModel& model,
                              const Recording& recording, const BaseParameters& base,
                              const CalibrationOptions& options, int folds, std::uint64_t seed,
                              const Progress& progress = {});

}  // namespace elastocal
