// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/planning/execute_motion.hpp"

namespace elastocal::cli {

/// A line that names the joints that a motion lacks; empty if there are none.
std::string DescribeOpenJoints(const std::vector<std::string>& names);

/// Table of the errors for each kind of knowledge about the robot.
std::string DescribeExecutions(const std::vector<Execution>& executions);

}  // namespace elastocal::cli
