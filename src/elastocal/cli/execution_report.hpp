// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/planning/execute_motion.hpp"

namespace elastocal::cli {

/// A line about joints of which a motion says nothing; empty where there are none.
std::string DescribeOpenJoints(const std::vector<std::string>& names);

/// A table of what each way to know the robot gave.
std::string DescribeExecutions(const std::vector<Execution>& executions);

}  // namespace elastocal::cli
