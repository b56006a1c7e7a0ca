// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "elastocal/calibration/placement.hpp"

namespace elastocal {

/// A direction of up, by torque sensors, that differs from the stated one.
struct UpByTorques {
  Eigen::Vector3d up = Eigen::Vector3d::Zero();  ///< of length 1, in the frame of the recording
  double angle = 0.0;                            ///< angle between it and the stated direction, rad
  double left =
      /// Rms of measured minus static torques with `up`, without the mean of each sensor, N.m.
      0.0;
  double stated = 0.0;  ///< the same with the stated direction
};

/// Finds out whether torque sensors show another direction of up than stated, for a robot whose
/// root link is held in all trials. Static torques are linear in gravity, so that its direction is
/// estimated from all sensors together, with a bias of each. It contradicts the stated one if it is
/// at least 30 degrees off and leaves less than a quarter of the squares; errors of masses affect
/// both alike. Nothing with fewer than three sensors or ten postures. The opposite direction (150
/// degrees or more) may as well be the opposite sign of all sensors, which FindContradictoryTorques
/// names.
std::optional<UpByTorques> FindUpByTorques(const ErrorModel& model, const Recording& recording,
                                           double slip_m);

/// Text such as "`up` in experiment.yaml is wrong: by 15 torque sensors, x points up ...".
std::string Describe(const UpByTorques& found);

}  // namespace elastocal
