// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "elastocal/calibration/placement.hpp"

namespace elastocal {

/// An axis up that cannot be: a robot on its feet would have fallen.
struct UpContradiction {
  double tilt = 0.0;       ///< of the way from its feet to its centre of mass against up, rad
  std::string axis;        ///< of the cameras that would be up instead: "y", "-x"
  double axis_tilt = 0.0;  ///< against that axis, rad
};

/// Whether the robot stands on its feet as gravity in the recording says: its centre of mass (its
/// root link where the robot description has no masses) is above its feet, not beside or below
/// them. Median over the postures of trials with a support; by nominal geometry, which is far from
/// mattering: a robot that stands leans by some degrees, a wrong axis is 90 or 180 degrees off.
std::optional<UpContradiction> FindWrongUp(const ErrorModel& model, const Recording& recording);

/// "`up` in experiment.yaml: the robot would stand with its centre of mass 88 degrees off ..."
std::string Describe(const UpContradiction& found);

}  // namespace elastocal
