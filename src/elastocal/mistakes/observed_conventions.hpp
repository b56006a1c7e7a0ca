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
  /// Where the project has the wrong convention: the robot in the right one; `undone` is unchanged.
  std::optional<ObservedRobot> robot = {};
};

/// Cameras whose attitudes in the project are those of their bodies, x ahead and z up, as robot
/// descriptions have them. Nothing where there are no images.
std::optional<WrittenConvention> CamerasAsBodies(const ObservedRobot& model,
                                                 const Observations& observations);

/// One of several that measure alike: an instrument of the kind, a "camera" or a "tag".
struct MeasuredBy {
  std::string kind, name;
  int quantity = -1;  ///< of a camera or a tag: its pose
};

/// For lengths: other units than m. For what trackers measured: quaternions with w first, attitudes
/// and poses from the other frame, left-handed axes. For images: u and v exchanged, v upwards,
/// corners that run clockwise or are counted from another one. For inertial units: axes that are
/// left-handed. For heights: the sign. `of`: what this one measured alone.
std::vector<WrittenConvention> WrittenConventions(const ObservedRobot& model,
                                                  const Observations& observations,
                                                  const std::optional<MeasuredBy>& of = {});

/// Tags of ten times their size, or a tenth: cm, or a slip of the point.
std::vector<WrittenConvention> TagsInOtherUnits(const ObservedRobot& model,
                                                const Observations& observations);

/// Whether an observation is of this one.
bool IsMeasuredBy(const ObservedRobot& model, const Observation& observation, const MeasuredBy& of);

/// Bodies, cameras, tags, inertial units and gauges of which there are two or more.
std::vector<MeasuredBy> SeveralAlike(const ObservedRobot& model, const Observations& observations);

}  // namespace elastocal
