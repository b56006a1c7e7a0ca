#pragma once

#include <array>

#include "elastocal/contact/contact_model.hpp"

namespace elastocal {

/// What varies in touches, each with a standard deviation of its own: noise of the touches, effects
/// of sessions, and the deviations of robot, plates and tables from nominal by kind. The data
/// decide all of them (variance components).
enum class ContactSource {
  kHeight,         ///< noise of one touch along the table's normal, m
  kTilt,           ///< noise of one touch in each tilt, rad
  kSessionHeight,  ///< height of the table that differs between sessions, m
  kSessionTilt,    ///< likewise its tilts, rad
  kTableTilt,      ///< tilt of a table against level, rad
  kPlateTilt,      ///< tilt of a plate on its link, rad
  kLegOffset,      ///< zero offsets (theta) of joints of legs, rad
  kTrunkOffset,    ///< of joints that carry several plates, rad
  kLimbOffset,     ///< of all other joints, rad
  kLength,         ///< lengths of the robot, m
  kAngle,          ///< all other angles of the robot: how axes are tilted, rad
  kTorsion,        ///< compliances about (along) joints' axes, in units of their prior
  kBending,        ///< compliances across them, likewise
};
inline constexpr int kContactSourceCount = 13;

/// height, tilt, session_height, ...
const char* ContactSourceName(ContactSource source);

/// Whether a source is measured in radians.
bool IsAngular(ContactSource source);

/// Standard deviations by source, SI.
struct ContactSpread {
  std::array<double, kContactSourceCount> sd;

  /// Before any data are seen.
  ContactSpread();
  double& operator[](ContactSource source) { return sd[static_cast<int>(source)]; }
  double operator[](ContactSource source) const { return sd[static_cast<int>(source)]; }
};

/// The source of a parameter of the robot's, and the unit in which its deviation counts there (1,
/// but for compliances: how far joints give way under their largest torque).
struct SourceOfParameter {
  ContactSource source = ContactSource::kLength;
  double unit = 1.0;
};

/// One for each parameter of the robot; those of T0 have no meaning.
std::vector<SourceOfParameter> SourcesOfParameters(const ContactModel& model);

}  // namespace elastocal
