// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// How well a calibration tells where a link is in the frame of the root link, springs aside: the
/// error to be expected of the calibrated robot description, root mean square over the recorded
/// postures. Markers that are fitted do not show it: a whole limb may turn or be displaced with the
/// markers on it, as far as their places on the links are not known.
struct FramePrecision {
  int link = 0;
  double position_sd = 0.0;  ///< of the distance to where it truly is, m
  double attitude_sd = 0.0;  ///< of the angle, rad
};

/// One entry a link, in their order, but for links behind a joint that moves no seen marker: of
/// these the recording says nothing. From the covariance of all estimates, to first order;
/// parameters that are held are taken as right, and corrections beside geometry and springs
/// (eccentricity, gear ...) are left out.
std::vector<FramePrecision> AssessFrames(const CalibrationResult& result,
                                         const Recording& recording, const std::vector<int>& ends);

}  // namespace elastocal
