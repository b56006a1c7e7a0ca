// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// Units of measured and estimated quantities.
enum class SourceUnit { kMetre, kRadian, kAcceleration, kPixel, kNone };

/// A source of variation with a standard deviation: noise of an instrument, effects of sessions, or
/// deviations of robot and quantities from nominal, by kind.
struct Source {
  enum class Role {
    kNoise,  ///< noise of measurements, whose size the data determine
    kPrior,  ///< spread of estimated values, likewise (variance components)
    kFixed,  ///< spread of estimated values with a fixed standard deviation
  };
  std::string name;
  SourceUnit unit = SourceUnit::kNone;
  double sd = 1.0;  ///< before any data are seen, SI
  Role role = Role::kPrior;
  double own_weight = 1.0;  ///< number of numbers for which `sd` counts beside the data
};

/// Sources that every robot has; those of single instruments come after them.
enum CommonSource {
  kHeight,         ///< noise of one flush touch along the table's normal, m
  kTilt,           ///< noise of one flush touch in each tilt, rad
  kSessionHeight,  ///< height of the table, which differs between sessions, m
  kSessionTilt,    ///< tilts of the table, likewise, rad
  kTrackerPlace,   ///< place of a tracker or wire, which differs between sessions, m
  kTrackerTurn,    ///< rotation of a tracker, likewise, rad
  kTableTilt,      ///< tilt of a table against level, rad
  kPlateTilt,      ///< tilt of a plate on its link, rad
  kLegOffset,      ///< zero offsets (theta) of joints of legs, rad
  kTrunkOffset,    ///< zero offsets of joints that carry several observed links, rad
  kLimbOffset,     ///< zero offsets of all other joints, rad
  kLength,         ///< lengths of the robot, m
  kAngle,          ///< all other angles of the robot: tilts of axes, rad
  kTorsion,        ///< compliances about (along) joints' axes, in units of their prior
  kBending,        ///< compliances across joints' axes, likewise
  kCause,          ///< corrections (causes beyond springs), likewise
  kUnknownPlace,   ///< unknown place: 1 m
  kUnknownTurn,    ///< unknown rotation: 1 rad
  kRootTilt,       ///< tilt of a root link that is held still: 1 degree
  kCommonSources,  ///< number of common sources
};

/// The common sources.
std::vector<Source> CommonSources();

/// Standard deviations by source, SI.
struct Spread {
  std::vector<double> sd;

  double& operator[](int source) { return sd[static_cast<std::size_t>(source)]; }
  double operator[](int source) const { return sd[static_cast<std::size_t>(source)]; }
};

/// Standard deviations before any data are seen.
Spread FirstSpread(const std::vector<Source>& sources);

}  // namespace elastocal
