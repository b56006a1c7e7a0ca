// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/observation/observed_robot.hpp"

namespace elastocal {

/// A convention in which poses may have been written, other than the tables'.
struct WrittenConvention {
  std::string what;     ///< how it would be written: "w comes first in the quaternions of bodies"
  std::string right;    ///< how the tables have it: "x, y, z, w"
  Observations undone;  ///< rewritten in the convention of the tables
};

/// For what trackers measured: quaternions with w first, attitudes and poses from the other frame,
/// left-handed axes. (Corners of tags in another order are a tag that is mounted another way.)
std::vector<WrittenConvention> WrittenConventions(const ObservedRobot& model,
                                                  const Observations& observations);

}  // namespace elastocal
