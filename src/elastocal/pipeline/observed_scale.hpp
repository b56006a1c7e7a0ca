// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "elastocal/calibration/camera_scale.hpp"
#include "elastocal/observation/observation_fit.hpp"

namespace elastocal {

/// The factor by which all lengths that trackers and wires measured are off, by the pattern that
/// it leaves in the lengths of the robot, where no robot has that (FindWrongScale). Nothing where
/// no instrument measures lengths, or the lengths do not tell it.
std::optional<CommonScale> FindObservedScale(const ObservedRobot& model,
                                             const Observations& observations,
                                             const ObservationFit& fit);

}  // namespace elastocal
