// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/observation/observed_robot.hpp"

namespace elastocal {

/// Finds plates that touch two tables of different heights in one file; one sentence each. By
/// nominal kinematics their touches lie at two heights whose distance is more than twice the
/// scatter of one. A nominal robot errs by some millimetres, so that tables of more similar heights
/// are not found.
std::vector<std::string> FindTwoTables(const ObservedRobot& model,
                                       const Observations& observations);

}  // namespace elastocal
