#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/frame_interval.hpp"
#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// Which frames of a trial count as measured at rest (paper, section 5.1).
struct StableSampleOptions {
  /// All markers must be slower, m/s; 0 stands for `threshold_factor` times the resting speed that
  /// EstimateRestingSpeed finds, but within the two limits below.
  double threshold_m_per_s = 0.0;
  /// With normal noise of equal size, 63 resting markers all stay below 4 times the median speed
  /// for hours; below 3.5 times, for ten minutes.
  double threshold_factor = 4.0;
  double least_threshold_m_per_s = 0.001;  ///< for data without noise
  double threshold_limit_m_per_s = 0.02;   ///< for trials that never rest
  double hold_s = 0.3;                     ///< shortest time at rest
  int samples_per_run = 1;
  double least_visible = 0.5;  ///< share of the markers that must have a speed in a frame
};

/// Why a frame is not among the samples.
enum class UnusedReason {
  kMoving,         ///< a marker at the threshold or above
  kTooFewVisible,  ///< fewer markers with a speed than asked for
  kTooShort,       ///< at rest, for less than the hold time
  kSpare,          ///< at rest for long enough, but other frames stand for this run
};

/// Frames that are not used, all for the same reason.
struct UnusedFrames {
  FrameInterval frames;
  UnusedReason reason = UnusedReason::kMoving;
  int fastest_marker = -1;  ///< column of the trajectories; only for kMoving
};

struct StableSamples {
  double threshold_m_per_s = 0.0;               ///< as used
  std::optional<double> resting_speed_m_per_s;  ///< where the threshold was estimated
  bool threshold_limited = false;               ///< the estimate was above the limit
  std::vector<FrameInterval> runs;              ///< at rest for at least the hold time, in order
  std::vector<int> frames;                      ///< the samples, run by run, rising
  std::vector<int> run_of_frame;                ///< as `frames`: index into `runs`
  std::vector<int> samples_of_marker;  ///< as the given markers: samples in which it is seen
  std::vector<UnusedFrames> unused;    ///< in order; with `frames` covers the trial

  /// Number of frames not used for `reason`.
  int UnusedCount(UnusedReason reason) const;
};

/// frames x markers, m/s: length of the central difference of each marker's positions (which should
/// be filtered); NaN where the marker or one of its two neighbours in time is not seen.
Eigen::MatrixXd MarkerSpeeds(const MarkerTrajectories& trajectories);

/// Sets the speeds of each marker to NaN within `margin_s` of the ends of its unbroken pieces, and
/// of the trial: there a filter knows only one side and lets more noise pass, which at rest would
/// look like motion.
void ForgetEdges(const MarkerTrajectories& trajectories, double margin_s, Eigen::MatrixXd& speeds);

/// Speed that noise and vibration leave to a marker at rest, m/s: over windows of `window_s`, the
/// median speed of all given markers and frames, and of these medians the one that 5 % of the
/// windows stay below. Valid if the robot rests for a tenth of the time or so, or if most markers
/// stand still throughout; too large for a trial without any rest. NaN where no speed is known.
///
/// `speeds` as of MarkerSpeeds; `markers` are columns of it.
double EstimateRestingSpeed(const Eigen::MatrixXd& speeds, const std::vector<int>& markers,
                            double rate_hz, double window_s);

/// Runs of frames in which all visible ones of `markers` are slower than a threshold for at least
/// the hold time, and of each run `samples_per_run` equally spaced frames (the middle one, for 1;
/// all, of a run that has fewer), the same for all markers so that no marker weighs more than
/// another. They are taken among the frames of the run in which most of the markers are seen.
///
/// `speeds` (m/s, frames x all markers) as of MarkerSpeeds, at `rate_hz`. Throws
/// std::invalid_argument for a marker that is no column of `speeds`, an empty list, or options out
/// of range.
StableSamples FindStableSamples(const Eigen::MatrixXd& speeds, const std::vector<int>& markers,
                                double rate_hz, const StableSampleOptions& options);

}  // namespace elastocal
