// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/measurement/trial_samples.hpp"

namespace elastocal {

/// Joins the samples of several trials to one recording, with trials and postures in the given
/// order. Its markers are those of the robot that are seen in any posture, in the robot's order.
/// Refused trials stay in the list of trials, without postures. Wrenches are NaN if a trial's log
/// has none. If no trial has any torque (wrench), the recording has no rows of these.
Recording MergeTrials(const MarkedRobot& robot, const std::vector<TrialSamples>& trials,
                      const std::string& source);

}  // namespace elastocal
