// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "elastocal/calibration/placement.hpp"

namespace elastocal {

/// Another direction that points up by the torques of the robot's sensors.
struct UpByTorques {
  Eigen::Vector3d up = Eigen::Vector3d::Zero();  ///< of length 1, in the frame of the recording
  double angle = 0.0;                            ///< between it and the stated one, rad
  double left =
      0.0;  ///< rms of measured less static torques with it, N.m, each sensor's mean apart
  double stated = 0.0;  ///< the same with the stated one
};

/// Whether the torque sensors of a robot whose root link is held in all trials show that another
/// direction is up. Static torques are linear in gravity, so that its direction is estimated from
/// all sensors together, with a bias of each. It is another one than stated where it is 30 degrees
/// off or more and leaves less than a quarter of the squares: errors of masses are shared by both.
/// Nothing with fewer than three sensors or ten postures. The opposite direction (150 degrees and
/// more) is as well the opposite sign of all sensors, which FindContradictoryTorques names.
std::optional<UpByTorques> FindUpByTorques(const ErrorModel& model, const Recording& recording,
                                           double slip_m);

/// "`up` in experiment.yaml is wrong: by 15 torque sensors, x points up ..."
std::string Describe(const UpByTorques& found);

}  // namespace elastocal
