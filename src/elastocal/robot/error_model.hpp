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

/// A leg that can stand on the floor and carry the waist, of lumped compliance (paper section 2.2).
struct SupportLeg {
  std::string name;         ///< its compliances are `<name>.compliance_x`...
  int link = 0;             ///< its foot: stands still when the leg supports
  std::vector<int> joints;  ///< between waist and foot, from the waist outwards
};

/// Which elastic parameters a model has (eq. 5 to 7); by default none.
struct Elasticity {
  /// A leg before its joints are looked up.
  struct Leg {
    std::string name;
    int link = 0;
  };
  std::vector<int> torsion =
      {};  ///< joints that give way about (prismatic: along) their axis, eq. 5
  std::vector<int> bending = {};  ///< revolute joints that give way across their axis as well
  std::vector<Leg> legs = {};     ///< with lumped compliance between foot and waist, eq. 6
  bool torque_bias = false;       ///< the torque sensors of the legs' joints have unknown biases
};

/// The robot with its markers and the named errors that can be estimated (paper section 2.1). Only
/// joints that move a marker or a supporting leg's foot have parameters; the model of one chain is
/// that of its markers.
struct ErrorModel {
  RobotTree tree;
  std::vector<JointPlacement> placements;  ///< one a joint of the tree
  std::vector<Marker> markers;
  Transform T_ref_waist = Transform::Identity();  ///< nominal pose of the root link, eq. 2
  Elasticity elasticity;                          ///< as asked for
  std::vector<SupportLeg> legs;                   ///< those of `elasticity`, with their joints
  std::vector<int> active_joints;                 ///< joints that have parameters, ascending
  /// T0; joints from the waist outwards, each with its geometric parameters and then compliance_z,
  /// _x, _y; legs, each with six compliances and then torque biases; markers.
  std::vector<Parameter> parameters;

  int parameter_count() const { return static_cast<int>(parameters.size()); }
  int marker_count() const { return static_cast<int>(markers.size()); }
  int leg_count() const { return static_cast<int>(legs.size()); }
};

/// Places the joints and names the parameters. Throws std::invalid_argument when two markers or
/// two legs share a name, a marker's link, a leg's link or a joint is not of the tree, a leg has no
/// joints, or a prismatic joint should bend.
ErrorModel MakeErrorModel(RobotTree tree, std::vector<Marker> markers,
                          const PlacementOptions& options = {}, const Elasticity& elasticity = {});

/// The same model with the markers of the given names only, in their order; legs and elasticity
/// stay. Throws InputError with
/// the nearest known name for one that it has not, std::invalid_argument for a name given twice.
ErrorModel SelectMarkers(const ErrorModel& model, const std::vector<std::string>& names);

}  // namespace elastocal
