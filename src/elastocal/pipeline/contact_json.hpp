// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "elastocal/observation/observation_figures.hpp"

namespace elastocal {

struct ContactRun;

/// How numbers of a unit are shown: 1e3 mm for 1 m.
struct ShownUnit {
  const char* name;
  double factor;
};
ShownUnit ShownUnitOf(SourceUnit unit);

/// Errors of touches as JSON: touches, height_mm, tilt_deg (over both axes), tilt_x_deg,
/// tilt_y_deg, max_height_mm; by_side the same for each plate that touched.
/// `instruments[]`: name, kind, observations, and rms by row with its unit (position_mm).
nlohmann::ordered_json FiguresJson(const ObservedRobot& model, const ObservationFigures& figures);

/// The section `contact` of summary.json (docs/formats.md).
nlohmann::ordered_json ContactJson(const ContactRun& run);

}  // namespace elastocal
