#pragma once

#include <nlohmann/json_fwd.hpp>

#include "elastocal/contact/touch_figures.hpp"

namespace elastocal {

/// Errors of touches as JSON: touches, height_mm, tilt_deg (over both axes), tilt_x_deg,
/// tilt_y_deg, max_height_mm; by_side the same for each plate that touched.
nlohmann::ordered_json FiguresJson(const ContactModel& model, const TouchFigures& figures);

}  // namespace elastocal
