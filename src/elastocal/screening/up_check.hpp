// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "elastocal/calibration/placement.hpp"

namespace elastocal {

/// A stated up axis that is impossible, because a robot on its feet would fall.
struct UpContradiction {
  double tilt = 0.0;  ///< angle between up and the line from its feet to its centre of mass, rad
  std::string axis;   ///< the cameras' axis that would be up instead: "y", "-x"
  double axis_tilt = 0.0;  ///< the same angle for that axis, rad
};

/// Finds out whether the robot stands upright by gravity in the recording: its centre of mass (its
/// root link where the robot description has no masses) is above its feet, not beside or below. The
/// median over the postures of trials with a support counts. Nominal geometry suffices: a robot
/// that stands leans by some degrees, a wrong axis is off by 90 or 180 degrees.
std::optional<UpContradiction> FindWrongUp(const ErrorModel& model, const Recording& recording);

/// Text such as "`up` in experiment.yaml: the robot would stand with its centre of mass 88 degrees
/// off ...".
std::string Describe(const UpContradiction& found);

}  // namespace elastocal
