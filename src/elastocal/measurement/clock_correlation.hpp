// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "elastocal/measurement/clock.hpp"

namespace elastocal {

/// A speed at a constant rate; NaN where unknown.
struct UniformSpeed {
  double start_s = 0.0;  ///< time of the first value
  double rate_hz = 0.0;
  Eigen::VectorXd values;
};

/// The predicted speed at a constant rate, by linear interpolation. NaN in holes of the log that
/// are longer than 0.1 s.
UniformSpeed Resample(const PredictedSpeed& predicted, double rate_hz);

/// Peaks of the correlation of the two speeds, over all lags in range.
struct CorrelationPeaks {
  bool overlap =
      false;  ///< whether any lag has enough data in common; otherwise the rest has no meaning
  double lag_s = 0.0;  ///< refined by a parabola
  double peak = 0.0;
  double second_peak = 0.0;   ///< 0 if there is none
  double second_lag_s = 0.0;  ///< lag at the second peak
  bool at_the_rim = false;    ///< the highest peak is at the first or the last lag
};

/// Normalised correlation at about 20 Hz. Both speeds must have the same rate.
CorrelationPeaks Correlate(const UniformSpeed& measured, const UniformSpeed& predicted,
                           const ClockOptions& options);

}  // namespace elastocal
