#pragma once

#include <string>
#include <vector>

#include "elastocal/io/urdf_writer.hpp"

namespace elastocal {

/// A joint as the URDF has it.
struct UrdfJoint {
  std::string name, type, parent, child;
  UrdfOrigin origin;
  bool dropped = false;  ///< the floating joint that carries the robot: not part of the tree
};

/// A URDF whose structure and numbers have been checked.
struct UrdfDocument {
  std::string root;                ///< name of the root link, after a floating joint was dropped
  std::vector<std::string> links;  ///< in the order of the file, without a dropped one
  std::vector<UrdfJoint> joints;   ///< in the order of the file
  /// The same robot written anew: only links and joints with what kinematics and statics need, one
  /// way of writing numbers, no dropped joint. Safe to be read by urdfdom, whose XML parser
  /// (TinyXML 1) does not stand arbitrary bytes.
  std::string canonical;
};

/// Checks a URDF and reads its outline. Throws InputError naming file and line: malformed XML, not
/// a robot, unknown, missing or twice given names, more than one parent or root, loops, mimic
/// joints that lead nowhere, text or infinities where a finite number belongs, zero axes, missing
/// limits, more than 5000 links or 16 MiB.
UrdfDocument CheckUrdf(const std::string& text, const std::string& source);

}  // namespace elastocal
