// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "elastocal/simulation/touch_table.hpp"

namespace elastocal {

/// How instruments other than cameras for markers measure the virtual robot, and how it touches
/// tables. Errors are standard deviations of normal draws; 0 switches an error off.
struct InstrumentOptions {
  double length_sd = 0.3e-3;                   ///< each coordinate, height and length of a wire, m
  double rotation_sd = 0.05 * M_PI / 180.0;    ///< attitudes of bodies, about each axis, rad
  double acceleration_sd = 0.01;               ///< mean of an accelerometer, m/s^2
  double pixel_sd = 0.3;                       ///< of a corner, px
  double blur_sd = 0.1;                        ///< of all corners of an image together, px
  double touch_height_sd = 0.3e-3;             ///< unevenness of a table under the plate: height, m
  double touch_tilt_sd = 0.05 * M_PI / 180.0;  ///< unevenness of a table under the plate: tilt, rad
  double table_height_sd = 5e-3;  ///< distance of a table from its place in the project, m
  double plate_edge = 0.08;       ///< edge of the square plates, m
  TouchOptions touch = {};
};

}  // namespace elastocal
