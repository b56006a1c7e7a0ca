#pragma once

#include <map>
#include <string>
#include <vector>

#include "elastocal/io/urdf_document.hpp"
#include "elastocal/io/urdf_element.hpp"

namespace elastocal {

struct UrdfLinkEntry {
  std::string name;
  UrdfElement element;
  int parent_joint = -1;
};

struct UrdfJointEntry {
  UrdfJoint joint;
  UrdfElement element;
  std::string mimic;  ///< the joint that it follows; empty where there is none
};

/// All links and joints of a URDF as they stand there, with the elements that describe them.
struct UrdfOutline {
  std::string robot;
  std::vector<UrdfLinkEntry> links;
  std::vector<UrdfJointEntry> joints;
  std::map<std::string, int> link_index, joint_index;
  int root = -1;
};

/// The <origin> of a joint or an inertia; zeros for what is left out.
UrdfOrigin ReadUrdfOrigin(const UrdfElement& parent);

/// Reads the outline of <robot> and checks that it is a tree (see CheckUrdf). The outline refers to
/// both arguments.
UrdfOutline ReadUrdfOutline(const tinyxml2::XMLElement& robot, const std::string& source);

}  // namespace elastocal
