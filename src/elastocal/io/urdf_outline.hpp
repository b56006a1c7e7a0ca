#pragma once

#include <map>
#include <string>
#include <vector>

#include "elastocal/io/urdf_writer.hpp"
#include "elastocal/io/xml_element.hpp"

namespace elastocal {

struct UrdfLink {
  std::string name;
  XmlElement element;
  int parent_joint = -1;
};

struct UrdfJoint {
  std::string name, type;
  UrdfOrigin origin;
  XmlElement element;
  int parent = -1, child = -1;  ///< links
  int leader = -1;              ///< the joint that it mimics
  bool dropped = false;         ///< the floating joint that carries the robot: not part of the tree
};

/// All links and joints of a URDF in the order of the file, with the elements that describe them.
struct UrdfOutline {
  std::string robot;
  std::vector<UrdfLink> links;
  std::vector<UrdfJoint> joints;
  std::map<std::string, int> link_index, joint_index;
  int root = -1;  ///< link, after a floating joint was dropped
};

/// The origin of a joint or an inertia; zeros for what is left out.
UrdfOrigin ReadUrdfOrigin(const XmlElement& parent);

/// Reads the outline of a URDF and checks that it is a tree. Throws InputError naming file and
/// line: not a robot, unknown, missing or twice given names, more than one parent or root, loops,
/// mimic joints that lead nowhere, unknown types, origins that are not numbers, more than 5000
/// links or joints. The outline refers to `xml`.
UrdfOutline ReadUrdfOutline(const XmlText& xml);

}  // namespace elastocal
