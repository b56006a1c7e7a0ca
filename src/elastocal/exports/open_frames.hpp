// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/project/project.hpp"
#include "elastocal/validation/common_parameters.hpp"

namespace elastocal {

/// Describes hands and feet whose last joint has a rotation about its axis, or a translation along
/// it, that is not determined (status unsupported). The first line says what would determine them,
/// each further line which frame is uncertain by how much. Empty where there is no such frame.
std::vector<std::string> DescribeOpenFrames(const Project& project,
                                            const CalibrationEstimate& estimate);

}  // namespace elastocal
