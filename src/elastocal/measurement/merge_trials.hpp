#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/measurement/trial_samples.hpp"

namespace elastocal {

/// The samples of several trials as one recording, trials and postures in the given order, with
/// those of the robot's markers that are seen in any posture, in the robot's order. Trials that
/// were refused stay in the list of trials, without postures. Wrenches are NaN where a trial's log
/// has none; without any torque or wrench at all the recording has none (no rows).
Recording MergeTrials(const MarkedRobot& robot, const std::vector<TrialSamples>& trials,
                      const std::string& source);

}  // namespace elastocal
