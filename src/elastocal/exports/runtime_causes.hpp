// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>

#include "elastocal/io/calibration_file.hpp"
#include "elastocal/robot/robot_tree.hpp"
#include "elastocal/runtime/runtime_model.hpp"

namespace elastocal {

/// Applies the causes beyond geometry and springs (corrections.hpp) that the calibration found to a
/// robot model, as far as they depend on motion and loads only.
void ApplyCauses(const RobotTree& tree, const StoredCalibration& calibration, RuntimeModel& model);

/// Names of the causes that ApplyCauses applies.
std::set<std::string> CausesAtRunTime(const RobotTree& tree, const StoredCalibration& calibration);

}  // namespace elastocal
