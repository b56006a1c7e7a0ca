// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/frame_interval.hpp"
#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// When the robot counts as at rest in a frame (paper, section 5.1).
struct StableSampleOptions {
  /// At rest, all markers are slower than this, m/s. 0 stands for `threshold_factor` times the
  /// speed that EstimateRestingSpeed returns, within the two limits below.
  double threshold_m_per_s = 0.0;
  /// With normal noise of equal size, the speeds of 63 resting markers all stay below 4 times their
  /// median for hours, and below 3.5 times for ten minutes.
  double threshold_factor = 4.0;
  double least_threshold_m_per_s = 0.001;  ///< for data without noise
  double threshold_limit_m_per_s = 0.02;   ///< for trials that never rest
  double hold_s = 0.3;                     ///< shortest time at rest
  int samples_per_run = 1;
  double least_visible = 0.5;  ///< share of the markers that must have a speed in a frame
};

/// Why a frame is not among the samples.
enum class UnusedReason {
  kMoving,         ///< the speed of a marker is at the threshold or above
  kTooFewVisible,  ///< too few markers have a speed
  kTooShort,       ///< at rest, but for less than `hold_s`
  kSpare,          ///< at rest for long enough, but other frames of this run are the samples
};

/// Frames that are not used, all for the same reason.
struct UnusedFrames {
  FrameInterval frames;
  UnusedReason reason = UnusedReason::kMoving;
  int fastest_marker = -1;  ///< column of the trajectories; only for kMoving
};

struct StableSamples {
  double threshold_m_per_s = 0.0;               ///< as used
  std::optional<double> resting_speed_m_per_s;  ///< if the threshold was estimated
  bool threshold_limited = false;               ///< the estimate was above the limit
  std::vector<FrameInterval> runs;              ///< runs at rest of at least `hold_s`, in order
  std::vector<int> frames;                      ///< the samples, run by run, ascending
  std::vector<int> run_of_frame;                ///< for each of `frames`, index into `runs`
  std::vector<int>
      samples_of_marker;  ///< for each given marker, number of samples in which it is seen
  std::vector<UnusedFrames> unused;  ///< in order; together with `frames` they cover the trial

  /// Number of frames not used for `reason`.
  int UnusedCount(UnusedReason reason) const;
};

/// Speeds of all markers, frames x markers, m/s: length of the central difference of the positions
/// (which should be filtered). NaN where the marker is not seen in the frame or in one of the two
/// frames beside it.
Eigen::MatrixXd MarkerSpeeds(const MarkerTrajectories& trajectories);

/// Sets the speeds of each marker to NaN within `margin_s` of the ends of its unbroken pieces and
/// of the trial. There the filter knows only one side and lets more noise pass, which at rest would
/// look like motion.
void ForgetEdges(const MarkerTrajectories& trajectories, double margin_s, Eigen::MatrixXd& speeds);

/// Speed of a marker at rest, which is due to noise and vibration, m/s. It is the 5 % quantile,
/// over windows of `window_s`, of the median speed of all given markers and frames in a window.
/// Valid if the robot rests for about a tenth of the time, or if most markers stand still
/// throughout; too large for a trial without any rest. NaN if no speed is known.
///
/// `speeds` is what MarkerSpeeds returns; `markers` are columns of it.
double EstimateRestingSpeed(const Eigen::MatrixXd& speeds, const std::vector<int>& markers,
                            double rate_hz, double window_s);

/// Finds runs of frames in which all visible ones of `markers` are slower than a threshold for at
/// least `hold_s`. The samples of a run are `samples_per_run` equally spaced frames (one: the
/// middle frame; more than the run has: all frames), among the frames of the run in which most
/// of the markers are seen. The samples are the same for all markers, so that no marker weighs more
/// than another.
///
/// `speeds` (m/s, frames x all markers) is what MarkerSpeeds returns, at `rate_hz`. Throws
/// std::invalid_argument for a marker that is not a column of `speeds`, for an empty list, and for
/// options out of range.
StableSamples FindStableSamples(const Eigen::MatrixXd& speeds, const std::vector<int>& markers,
                                double rate_hz, const StableSampleOptions& options);

}  // namespace elastocal
