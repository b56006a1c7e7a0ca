// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/observation/observed_robot.hpp"

namespace elastocal {

/// A convention in which something may have been written, other than the tables'.
struct WrittenConvention {
  std::string what;     ///< how it would be written: "w comes first in the quaternions of bodies"
  std::string right;    ///< how the tables have it: "x, y, z, w"
  std::string family;   ///< what it is if others of the family explain as much; empty: none
  Observations undone;  ///< rewritten in the convention of the tables
  bool turns_mountings = false;  ///< fits by mountings that are turned far, at least in part
  /// Of a convention of the project: the robot in the right one; `undone` is as it was.
  std::optional<ObservedRobot> robot = {};
};

/// Cameras whose attitudes in the project are those of their bodies, x ahead and z up, as robot
/// descriptions have them. Nothing where there are no images.
std::optional<WrittenConvention> CamerasAsBodies(const ObservedRobot& model,
                                                 const Observations& observations);

/// For what trackers measured: quaternions with w first, attitudes and poses from the other frame,
/// left-handed axes. For images: u and v exchanged, v upwards, corners that run clockwise (in
/// another order counterclockwise, they are those of a tag that is mounted another way). For
/// inertial units: axes that are left-handed.
std::vector<WrittenConvention> WrittenConventions(const ObservedRobot& model,
                                                  const Observations& observations);

}  // namespace elastocal
