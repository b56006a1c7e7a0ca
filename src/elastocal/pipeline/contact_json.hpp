// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "elastocal/observation/observation_figures.hpp"

namespace elastocal {

struct ContactRun;

/// The unit in which users see a quantity, and its number for one SI unit: 1e3 mm for 1 m.
struct ShownUnit {
  const char* name;
  double factor;
};
ShownUnit ShownUnitOf(SourceUnit unit);

/// Errors as JSON. Of touches: touches, height_mm, tilt_deg (over both axes), tilt_x_deg,
/// tilt_y_deg, max_height_mm, and by_side the same for each plate that touched. Of other
/// instruments, in `instruments[]`: name, kind, observations, and rms by row with its unit
/// (position_mm).
nlohmann::ordered_json FiguresJson(const ObservedRobot& model, const ObservationFigures& figures);

/// The section `contact` of summary.json (docs/formats.md).
nlohmann::ordered_json ContactJson(const ContactRun& run);

}  // namespace elastocal
