// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/measurement/clock.hpp"
#include "elastocal/measurement/smoothed_log.hpp"
#include "elastocal/measurement/stable_samples.hpp"
#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// Markers and log of a trial, both filtered, with the relation of their clocks.
struct TimedTrial {
  const MarkerTrajectories& trajectories;
  const SmoothedLog& log;
  const ClockFit& clock;

  double CameraTime(int frame) const { return frame / trajectories.rate_hz; }
  double RobotTime(int frame) const { return clock.RobotTime(CameraTime(frame)); }
};

/// For each posture, the frames whose mean it is, ascending.
using PostureFrames = std::vector<std::vector<int>>;

/// One posture for each rest. A marker with a noisy speed can break a rest into several runs,
/// between which no joint moves (by more than 2 mrad or 2 mm). Only the run in which most markers
/// are seen is then used. The log must cover the runs.
PostureFrames RestPostures(const TimedTrial& trial, const StableSamples& rests);

/// One frame for each posture, about `rate_hz` times a second, from the first frame in motion to
/// the last. Frames that the log does not cover are left out.
PostureFrames MotionPostures(const TimedTrial& trial, const StableSamples& rests, double rate_hz);

}  // namespace elastocal
