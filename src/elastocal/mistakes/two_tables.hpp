// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/observation/observed_robot.hpp"

namespace elastocal {

/// Plates that touch two tables of different heights in one file, a sentence each: by nominal
/// kinematics, their touches lie at two heights that are further apart than twice what the touches
/// of one are. A nominal robot errs by some millimetres, so tables that are as close are not told.
std::vector<std::string> FindTwoTables(const ObservedRobot& model,
                                       const Observations& observations);

}  // namespace elastocal
