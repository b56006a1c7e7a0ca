// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// Expected error of a link's pose in the frame of the root link according to the calibrated robot
/// description, without springs: root mean square over the recorded postures. Fitted markers do not
/// show this error: a whole limb may be displaced together with its markers, as far as their
/// positions on the links are unknown.
struct FramePrecision {
  int link = 0;
  double position_sd = 0.0;  ///< standard deviation of the link's position (distance), m
  double attitude_sd = 0.0;  ///< standard deviation of the link's attitude (angle), rad
};

/// One entry for each link of `ends`, in that order. Links that depend on a joint without estimated
/// parameters (it moves no seen marker) are left out. The result follows from the covariance of all
/// estimates to first order, over about 20 postures. Held parameters count as exact; compliances,
/// markers and T0 are left out.
std::vector<FramePrecision> AssessFrames(const CalibrationResult& result,
                                         const Recording& recording, const std::vector<int>& ends);

}  // namespace elastocal
