// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// A speed seen by the cameras (of one marker, or a mean over markers), on the cameras' clock.
struct MeasuredSpeed {
  double rate_hz = 0.0;
  Eigen::VectorXd values;  ///< m/s; frame i is at i / rate_hz; NaN where unknown
};

/// The same speed by forward kinematics of the logged joint positions, on the robot's clock. It
/// must have passed the same filter as the measured speed; otherwise its sharper edges bias the
/// fit.
struct PredictedSpeed {
  Eigen::VectorXd time_s;  ///< strictly increasing
  Eigen::VectorXd values;  ///< m/s, one for each time
};

struct ClockOptions {
  double expected_lag_s = 0.0;  ///< middle of the range of lags that is searched
  double longest_lag_s = 10.0;  ///< how far the search goes to either side
  double window_s = 20.0;       ///< length of the windows whose lags give the drift
  double least_peak = 0.6;      ///< least correlation that is accepted
  /// The lag is ambiguous if the second peak is above this share of the highest, unless the
  /// residual variance at the second peak is `clear_residual_ratio` times as large. A regular
  /// cadence of postures makes a high second peak, but a good fit tells the two apart; a periodic
  /// motion fits both.
  double largest_second_peak = 0.95;
  double clear_residual_ratio = 4.0;
  double largest_line_residual_s = 0.010;  ///< largest distance of the windows' lags from the line
  double largest_sd_s = 0.002;  ///< largest standard deviation of the lag anywhere in the trial
};

enum class ClockState {
  kReliable,
  kNoOverlap,  ///< the two have too little data in common at any lag
  kWeak,       ///< correlation below `least_peak`: no motion, or the log of another robot
  kAmbiguous,  ///< two lags explain the motion about as well
  kAtTheRim,   ///< the correlation still rises at the end of the searched range
  kUnsteady,   ///< the windows' lags do not lie on a line: a clock jumped or a log has holes
  kImprecise,  ///< too little motion for `largest_sd_s`
};

/// The lag in one window of the trial.
struct WindowLag {
  double time_s = 0.0;  ///< middle of the window, on the cameras' clock
  double lag_s = 0.0;
  double sd_s = 0.0;
  bool used = false;  ///< false if the fit of the line found it an outlier
};

/// Relation of the robot's clock to that of the cameras: robot time = (1 + 1e-6 drift_ppm) camera
/// time - lag_s. With positive lag the robot's clock is behind, with positive drift it runs fast.
struct ClockFit {
  ClockState state = ClockState::kNoOverlap;
  double lag_s = 0.0;            ///< at camera time 0
  double drift_ppm = 0.0;        ///< 0 where `drift_estimated` is false
  bool drift_estimated = false;  ///< true with at least three windows with motion
  double sd_s = 0.0;             ///< largest standard deviation of the lag over the common time
  double peak = 0.0;             ///< correlation at the best lag, in [-1, 1]
  double second_peak = 0.0;   ///< correlation at the second peak, outside the slopes of the first
  double second_lag_s = 0.0;  ///< lag at the second peak
  double line_residual_s = 0.0;  ///< root mean square of used windows' lags from the line
  double overlap_s = 0.0;        ///< time during which both speeds are known
  std::vector<WindowLag> windows;

  /// Camera time of a robot time, s.
  double CameraTime(double robot_time_s) const {
    return (robot_time_s + lag_s) / (1.0 + 1e-6 * drift_ppm);
  }

  /// Robot time of a camera time, s.
  double RobotTime(double camera_time_s) const {
    return camera_time_s + 1e-6 * drift_ppm * camera_time_s - lag_s;
  }
};

/// Estimates lag and drift in two steps. The coarse step is the normalised correlation over all
/// lags in range at which the two have at least half of the shorter signal in common. The fine step
/// finds in each window the lag with the least squares, with a gain and an offset of its own, and
/// then a robust line (Theil-Sen, then biweight) through the windows' lags. Time is linear in the
/// number of frames. An unusable result is a state, never an exception; its numbers are then the
/// most likely ones.
///
/// Throws std::invalid_argument for signals without length or rate, times that do not increase, or
/// options that are not positive.
ClockFit EstimateClock(const MeasuredSpeed& measured, const PredictedSpeed& predicted,
                       const ClockOptions& options);

/// One sentence for a report: what the state means, with the figures that decided on it.
std::string Describe(const ClockFit& fit);

}  // namespace elastocal
