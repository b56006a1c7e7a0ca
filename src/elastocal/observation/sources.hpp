// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// Units of what is measured or estimated.
enum class SourceUnit { kMetre, kRadian, kAcceleration, kPixel, kNone };

/// Something that varies, with a standard deviation: noise of an instrument, effects of sessions,
/// the deviations of robot and quantities from nominal by kind.
struct Source {
  enum class Role {
    kNoise,  ///< of measurements: the data decide how large it is
    kPrior,  ///< of what is estimated: likewise (variance components)
    kFixed,  ///< of what is estimated: the standard deviation stays as it is
  };
  std::string name;
  SourceUnit unit = SourceUnit::kNone;
  double sd = 1.0;  ///< before any data are seen, SI
  Role role = Role::kPrior;
  double own_weight = 1.0;  ///< numbers that `sd` stands for beside those of the data
};

/// Sources that every robot has; those of single instruments follow.
enum CommonSource {
  kHeight,         ///< noise of one flush touch along the table's normal, m
  kTilt,           ///< noise of one flush touch in each tilt, rad
  kSessionHeight,  ///< height of the table that differs between sessions, m
  kSessionTilt,    ///< likewise its tilts, rad
  kTrackerPlace,   ///< where a tracker or wire stands that differs between sessions, m
  kTrackerTurn,    ///< likewise how it is turned, rad
  kTableTilt,      ///< tilt of a table against level, rad
  kPlateTilt,      ///< tilt of a plate on its link, rad
  kLegOffset,      ///< zero offsets (theta) of joints of legs, rad
  kTrunkOffset,    ///< of joints that carry several links that are observed, rad
  kLimbOffset,     ///< of all other joints, rad
  kLength,         ///< lengths of the robot, m
  kAngle,          ///< all other angles of the robot: how axes are tilted, rad
  kTorsion,        ///< compliances about (along) joints' axes, in units of their prior
  kBending,        ///< compliances across them, likewise
  kCause,          ///< corrections (causes beyond springs), likewise
  kUnknownPlace,   ///< where something is that nobody knows: 1 m
  kUnknownTurn,    ///< how something is turned that nobody knows: 1 rad
  kRootTilt,       ///< tilt against level of a root link that is held still: 1 degree
  kCommonSources,  ///< how many they are
};

/// The common sources.
std::vector<Source> CommonSources();

/// Standard deviations by source, SI.
struct Spread {
  std::vector<double> sd;

  double& operator[](int source) { return sd[static_cast<std::size_t>(source)]; }
  double operator[](int source) const { return sd[static_cast<std::size_t>(source)]; }
};

/// Before any data are seen.
Spread FirstSpread(const std::vector<Source>& sources);

}  // namespace elastocal
