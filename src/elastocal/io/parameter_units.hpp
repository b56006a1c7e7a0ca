// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace elastocal {

/// Units that a parameter can have by the last part of its name, and the largest value that is a
/// deviation of a robot and not a damaged file.
struct NamedUnits {
  std::vector<std::string> units;
  double most = std::numeric_limits<double>::infinity();
};

NamedUnits UnitsOf(const std::string& parameter);

}  // namespace elastocal
