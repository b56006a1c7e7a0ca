// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "elastocal/measurement/clock.hpp"
#include "elastocal/measurement/clock_correlation.hpp"
#include "elastocal/measurement/frame_interval.hpp"

namespace elastocal {

/// The lag in some frames of the measured speed (whose first frame is at time 0), by Gauss-Newton
/// on measured = gain predicted(t - lag) + offset, from `coarse_lag_s`. Its standard deviation
/// takes into account that residuals are correlated from frame to frame. Returns nothing if there
/// is no motion, if the two have too little in common, if the fit is poor (correlation below a
/// half), or if the lag is more than 0.5 s off the coarse one.
std::optional<WindowLag> FitWindowLag(const UniformSpeed& measured, const UniformSpeed& predicted,
                                      const FrameInterval& frames, double coarse_lag_s);

/// The lag as a line over the cameras' time.
struct LagLine {
  double middle_s = 0.0;  ///< time at which level and slope are uncorrelated
  double level_s = 0.0;   ///< lag at that time
  double slope = 0.0;     ///< change of the lag, s in one second
  double level_sd_s = 0.0;
  double slope_sd = 0.0;
  double residual_s = 0.0;  ///< root of the weighted mean square distance of the used windows

  double Lag(double time_s) const { return level_s + slope * (time_s - middle_s); }
  double Sd(double time_s) const;
};

/// Fits a robust line to at least three windows (Theil-Sen, then weighted least squares with
/// biweights) and marks the windows that it used.
LagLine FitLine(std::vector<WindowLag>& windows);

}  // namespace elastocal
