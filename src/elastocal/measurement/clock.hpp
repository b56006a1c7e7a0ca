#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// A speed seen by the cameras (of one marker, or a mean over markers), on the cameras' clock.
struct MeasuredSpeed {
  double rate_hz = 0.0;
  Eigen::VectorXd values;  ///< m/s, of frame i at i / rate_hz; NaN where unknown
};

/// The same speed by forward kinematics of the logged joint positions, on the robot's clock. Filter
/// it as the measured one, or its sharper edges bias the fit.
struct PredictedSpeed {
  Eigen::VectorXd time_s;  ///< strictly increasing
  Eigen::VectorXd values;  ///< m/s, as `time_s`
};

struct ClockOptions {
  double expected_lag_s = 0.0;  ///< middle of the range that is searched
  double longest_lag_s = 10.0;  ///< searched to either side
  double window_s = 20.0;       ///< pieces whose lags the drift is read from
  double least_peak = 0.6;      ///< correlation asked for
  /// Refused as ambiguous if the next peak is above this share of the highest, unless the residual
  /// variance at the next one is `clear_residual_ratio` times as large. A regular cadence of
  /// postures makes a high second peak, but a good fit tells the two apart; a periodic motion fits
  /// both.
  double largest_second_peak = 0.95;
  double clear_residual_ratio = 4.0;
  double largest_line_residual_s = 0.010;  ///< of the windows' lags from the line
  double largest_sd_s = 0.002;             ///< of the lag anywhere in the trial
};

enum class ClockState {
  kReliable,
  kNoOverlap,  ///< too little data in common, at any lag
  kWeak,       ///< correlation below `least_peak`: no motion, or another robot's
  kAmbiguous,  ///< two lags explain the motion about as well
  kAtTheRim,   ///< the correlation still rises at the end of the searched range
  kUnsteady,   ///< the windows' lags do not lie on a line: a clock jumped or a log has holes
  kImprecise,  ///< too little motion for `largest_sd_s`
};

/// The lag in one piece of the trial.
struct WindowLag {
  double time_s = 0.0;  ///< middle of the piece, on the cameras' clock
  double lag_s = 0.0;
  double sd_s = 0.0;
  bool used = false;  ///< false if the line fit found it an outlier
};

/// How the robot's clock stands to the cameras':
/// robot time = (1 + 1e-6 drift_ppm) camera time - lag_s.
/// Positive lag: the robot's clock is behind. Positive drift: it runs fast.
struct ClockFit {
  ClockState state = ClockState::kNoOverlap;
  double lag_s = 0.0;            ///< at camera time 0
  double drift_ppm = 0.0;        ///< 0 where `drift_estimated` is false
  bool drift_estimated = false;  ///< at least three windows with motion
  double sd_s = 0.0;             ///< largest standard deviation of the lag over the common time
  double peak = 0.0;             ///< correlation at the best lag, in [-1, 1]
  double second_peak = 0.0;      ///< at the next best one outside the first one's slopes
  double line_residual_s = 0.0;  ///< root mean square of used windows' lags from the line
  double overlap_s = 0.0;        ///< time for which both speeds are known
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

/// Estimates lag and drift. Coarse: normalised correlation over all lags in range, which must share
/// at least half of the shorter signal. Fine: in each window the lag that fits best by least
/// squares, with a gain and an offset of its own, then a robust line (Theil-Sen, then biweight)
/// through the windows' lags. Linear in the number of frames. An unusable result is a state, never
/// an exception; its numbers are then the best guess.
///
/// Throws std::invalid_argument for signals without length or rate, times that do not increase, or
/// options that are not positive.
ClockFit EstimateClock(const MeasuredSpeed& measured, const PredictedSpeed& predicted,
                       const ClockOptions& options);

/// One sentence for a report: what the state means, with the figures it was decided by.
std::string Describe(const ClockFit& fit);

}  // namespace elastocal
