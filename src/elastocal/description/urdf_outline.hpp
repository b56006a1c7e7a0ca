// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "elastocal/description/urdf_writer.hpp"
#include "elastocal/files/xml_element.hpp"

namespace elastocal {

/// A link of a URDF with the element that describes it.
struct UrdfLink {
  std::string name;
  XmlElement element;
  int parent_joint = -1;
  bool dropped = false;  ///< not part of the robot: separated by a floating or planar joint
};

/// A joint of a URDF with the element that describes it.
struct UrdfJoint {
  std::string name, type;
  UrdfOrigin origin;
  XmlElement element;
  int parent = -1, child = -1;  ///< links
  int leader = -1;              ///< the joint that it mimics; -1: none
  bool dropped = false;         ///< not part of the robot, or floating or planar
};

/// All links and joints of a URDF in the order of the file, with the elements that describe them.
struct UrdfOutline {
  std::string robot;
  std::vector<UrdfLink> links;
  std::vector<UrdfJoint> joints;
  std::map<std::string, int> link_index, joint_index;
  int root = -1;  ///< root link of the part that is the robot
  std::vector<std::string> warnings;
};

/// The origin of a joint or an inertia; numbers that are left out are zero.
UrdfOrigin ReadUrdfOrigin(const XmlElement& parent);

/// Reads the outline of a URDF and checks that it is a tree. Floating and planar joints divide it
/// into parts, because nothing measures them; the part with the most movable joints is the robot.
/// Throws InputError naming file and line: not a robot, unknown, missing or twice given names, more
/// than one parent or root, loops, mimic joints that lead nowhere, unknown types, origins that are
/// not numbers, more than 5000 links or joints. The outline refers to `xml`.
UrdfOutline ReadUrdfOutline(const XmlText& xml);

}  // namespace elastocal
