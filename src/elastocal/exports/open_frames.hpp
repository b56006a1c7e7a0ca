// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/project/project.hpp"
#include "elastocal/validation/common_parameters.hpp"

namespace elastocal {

/// Hands and feet whose last joint has a turn about its axis, or a place along it, that nothing has
/// told (status unsupported). The first line says what would tell them, each further one which
/// frame is open by how much; no lines where there is no such frame.
std::vector<std::string> DescribeOpenFrames(const Project& project,
                                            const CalibrationEstimate& estimate);

}  // namespace elastocal
