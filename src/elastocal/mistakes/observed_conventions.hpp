// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/observation/observed_robot.hpp"

namespace elastocal {

/// A convention of writing other than that of the tables, in which data may have been written.
struct WrittenConvention {
  std::string what;   ///< the convention: "w comes first in the quaternions of bodies"
  std::string right;  ///< the convention of the tables: "x, y, z, w"
  /// Common name, used if several conventions of the family explain as much; empty: none.
  std::string family;
  Observations undone;           ///< the observations, rewritten in the convention of the tables
  bool turns_mountings = false;  ///< it needs mountings that are rotated far, at least in part
  /// If the project has the wrong convention: the robot in the right one; `undone` is then
  /// unchanged.
  std::optional<ObservedRobot> robot = {};
};

/// The convention in which the attitudes of cameras in the project are those of their bodies (x
/// ahead, z up), as in robot descriptions. Nothing where there are no images.
std::optional<WrittenConvention> CamerasAsBodies(const ObservedRobot& model,
                                                 const Observations& observations);

/// One of several similar devices: an instrument of the given kind, a "camera" or a "tag".
struct MeasuredBy {
  std::string kind, name;
  int quantity = -1;  ///< pose of a camera or a tag; -1: of an instrument
};

/// The conventions that are tried. For lengths: other units than m. For trackers: quaternions with
/// w first, attitudes and poses of the other frame, left-handed axes. For images: u and v
/// exchanged, v upwards, corners that run clockwise or begin with another one. For inertial units:
/// left-handed axes. For heights: the sign. `of` restricts the conventions to what this device
/// measured.
std::vector<WrittenConvention> WrittenConventions(const ObservedRobot& model,
                                                  const Observations& observations,
                                                  const std::optional<MeasuredBy>& of = {});

/// Tags of ten times their size, or a tenth: given in cm, or with a shifted decimal point.
std::vector<WrittenConvention> TagsInOtherUnits(const ObservedRobot& model,
                                                const Observations& observations);

/// Whether an observation belongs to this device.
bool IsMeasuredBy(const ObservedRobot& model, const Observation& observation, const MeasuredBy& of);

/// Bodies, cameras, tags, inertial units and gauges, of each kind that occurs at least twice.
std::vector<MeasuredBy> SeveralAlike(const ObservedRobot& model, const Observations& observations);

}  // namespace elastocal
