#pragma once

#include <vector>

#include "elastocal/measurement/clock.hpp"
#include "elastocal/measurement/smoothed_log.hpp"
#include "elastocal/measurement/stable_samples.hpp"
#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// Markers and log of a trial, both filtered, with their clocks.
struct TimedTrial {
  const MarkerTrajectories& trajectories;
  const SmoothedLog& log;
  const ClockFit& clock;

  double CameraTime(int frame) const { return frame / trajectories.rate_hz; }
  double RobotTime(int frame) const { return clock.RobotTime(CameraTime(frame)); }
};

/// The frames of which each posture is the mean, rising.
using PostureFrames = std::vector<std::vector<int>>;

/// One posture a rest. A marker with a noisy speed can break a rest in two runs; of the runs
/// between which no joint moved (by more than 2 mrad or 2 mm), the one in which most markers are
/// seen stands for all. The log must cover the runs.
PostureFrames RestPostures(const TimedTrial& trial, const StableSamples& rests);

/// One frame a posture, about `rate_hz` times a second, from the first frame in motion to the last;
/// only where the log covers it.
PostureFrames MotionPostures(const TimedTrial& trial, const StableSamples& rests, double rate_hz);

}  // namespace elastocal
