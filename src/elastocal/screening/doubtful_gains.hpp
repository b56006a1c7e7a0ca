// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/screening/recording_fault.hpp"

namespace elastocal {

/// Gains of joints, in all postures, that are too uncertain for an objection and too large to be
/// ignored: larger than a good robot has (LeastSize), and by so many standard deviations as one
/// clean recording in fifty shows, whatever the number of joints (Student's t of the postures). A
/// gain is measured as one more unknown beside what was fitted (MeasureFaults) or, where the fit
/// has a gear or lead of the joint, by that. Joints that rods move are left out, because levers of
/// the rods are errors of the robot.
std::vector<RecordingFault> FindDoubtfulGains(const CalibrationResult& result,
                                              const Recording& recording,
                                              const CalibrationOptions& options);

/// Text such as "arm_4_joint: its positions may be 1.0110 +- 0.0027 times the true ones, ...".
std::string DescribeDoubtfulGain(const RecordingFault& gain, const RobotTree& tree);

}  // namespace elastocal
