#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/validation/metrics.hpp"

namespace elastocal {

/// The models of paper section 6.1.4 on one recording, by ModelKind.
struct ModelComparison {
  std::array<CalibrationResult, 3> results;
  std::array<ErrorMetrics, 3> metrics;      ///< over the observations that the geometric model kept
  std::array<ErrorMetrics, 3> metrics_all;  ///< over all, outliers included

  const CalibrationResult& geometric() const { return results[2]; }
};

/// Called with the number of finished steps and of all steps; may be empty.
using Progress = std::function<void(int done, int total)>;

/// Calibrates all three models. The geometric one comes first and decides which observations are
/// outliers, so that the three are judged on the same data.
ModelComparison CompareModels(const ErrorModel& model, const Recording& recording,
                              const BaseParameters& base, const CalibrationOptions& options);

struct CrossValidation {
  int folds = 0;
  std::array<ErrorMetrics, 3> metrics;  ///< of held-out observations, by ModelKind
  int unconverged = 0;                  ///< fits that did not converge
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
