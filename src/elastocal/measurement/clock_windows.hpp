#pragma once

#include <optional>
#include <vector>

#include "elastocal/measurement/clock.hpp"
#include "elastocal/measurement/clock_correlation.hpp"
#include "elastocal/measurement/frame_interval.hpp"

namespace elastocal {

/// The lag in some frames of the measured speed (whose first frame is at time 0), by Gauss-Newton
/// from `coarse_lag_s` on measured = gain predicted(t - lag) + offset. Its standard deviation
/// allows for the residuals' correlation from frame to frame. Nothing if there is no motion, too
/// little in common, a poor fit (correlation below a half), or a lag more than 0.5 s off the coarse
/// one.
std::optional<WindowLag> FitWindowLag(const UniformSpeed& measured, const UniformSpeed& predicted,
                                      const FrameInterval& frames, double coarse_lag_s);

/// Lag as a line over the cameras' time.
struct LagLine {
  double middle_s = 0.0;  ///< time at which level and slope are uncorrelated
  double level_s = 0.0;   ///< lag then
  double slope = 0.0;     ///< s of lag a second
  double level_sd_s = 0.0;
  double slope_sd = 0.0;
  double residual_s = 0.0;  ///< root of the weighted mean square over the used windows

  double Lag(double time_s) const { return level_s + slope * (time_s - middle_s); }
  double Sd(double time_s) const;
};

/// Robust line through at least three windows (Theil-Sen, then weighted least squares with
/// biweights); marks the windows used.
LagLine FitLine(std::vector<WindowLag>& windows);

}  // namespace elastocal
