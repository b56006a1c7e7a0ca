// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Tells nominal robots apart: the errors of a calibration are deviations from one of them and mean
/// nothing on another. 16 hexadecimal digits (FNV-1a, 64 bit) over every joint's name, type,
/// parent, mimicking and placement (radians and metres, rounded to 1e-9). Links, limits, inertia,
/// visuals, comments and markers do not count.
std::string NominalFingerprint(const ErrorModel& model);

/// A fingerprint of the text of a calibration.yaml. Results that are made with a calibration hold
/// its fingerprint, so that they are not shown together with another one.
std::string CalibrationFingerprint(std::string_view text);

}  // namespace elastocal
