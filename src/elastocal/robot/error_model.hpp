#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/parameters.hpp"
#include "elastocal/robot/placement.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// A marker fixed to a link; nominal position in the link's frame, m.
struct Marker {
  std::string name;
  int link = 0;
  Eigen::Vector3d p_link_marker = Eigen::Vector3d::Zero();
};

/// The robot with its markers and the named errors that can be estimated (paper section 2.1). Only
/// joints that move a marker have parameters; the model of one chain is that of its markers.
struct ErrorModel {
  RobotTree tree;
  std::vector<JointPlacement> placements;  ///< one a joint of the tree
  std::vector<Marker> markers;
  Transform T_ref_waist = Transform::Identity();  ///< nominal pose of the root link, eq. 2
  std::vector<int> active_joints;                 ///< joints that move a marker, ascending
  std::vector<Parameter> parameters;  ///< T0, then joints from the waist outwards, then markers

  int parameter_count() const { return static_cast<int>(parameters.size()); }
  int marker_count() const { return static_cast<int>(markers.size()); }
};

/// Places the joints and names the parameters. Throws std::invalid_argument when two markers share
/// a name or a marker's link is not of the tree.
ErrorModel MakeErrorModel(RobotTree tree, std::vector<Marker> markers,
                          const PlacementOptions& options = {});

/// The same model with the markers of the given names only, in their order. Throws InputError with
/// the nearest known name for one that it has not, std::invalid_argument for a name given twice.
ErrorModel SelectMarkers(const ErrorModel& model, const std::vector<std::string>& names);

}  // namespace elastocal
