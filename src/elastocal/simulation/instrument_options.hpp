// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "elastocal/simulation/touch_table.hpp"

namespace elastocal {

/// How instruments beside markers measure the virtual robot, and how it touches tables: standard
/// deviations of normal draws. 0 switches an error off.
struct InstrumentOptions {
  double length_sd = 0.3e-3;                   ///< positions, heights, wires, each number, m
  double rotation_sd = 0.05 * M_PI / 180.0;    ///< attitudes of bodies, about each axis, rad
  double acceleration_sd = 0.01;               ///< mean of an accelerometer, m/s^2
  double pixel_sd = 0.3;                       ///< of a corner, px
  double blur_sd = 0.1;                        ///< of all corners of an image together, px
  double touch_height_sd = 0.3e-3;             ///< the table under the plate is uneven: height, m
  double touch_tilt_sd = 0.05 * M_PI / 180.0;  ///< ... and tilts, rad
  double table_height_sd = 5e-3;  ///< how far a table is from where the project has it, m
  double plate_edge = 0.08;       ///< of square plates, m
  TouchOptions touch = {};
};

}  // namespace elastocal
