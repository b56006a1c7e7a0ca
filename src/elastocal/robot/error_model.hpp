// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/corrections.hpp"
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

/// A leg that can stand on the floor and carry the waist, with its lumped compliance, if it has
/// one (paper section 2.2).
struct SupportLeg {
  std::string name;         ///< its compliances are `<name>.compliance_x`...
  int link = 0;             ///< its foot, which stands still while the leg supports the robot
  std::vector<int> joints;  ///< between waist and foot, from the waist outwards
};

/// Which elastic parameters a model has (eq. 5 to 7); by default none.
struct Elasticity {
  /// A leg whose joints have not been looked up yet.
  struct Leg {
    std::string name;
    int link = 0;
  };
  std::vector<int> torsion =
      {};  ///< joints that are elastic about (prismatic: along) their axis, eq. 5
  std::vector<int> bending = {};  ///< revolute joints that are elastic across their axis too
  /// Joints on the root link up to which the root link bends. For such a joint the root link turns
  /// about its origin by the load of the joint, in addition to the joint's own deflection, like a
  /// beam between the two whose ends turn.
  std::vector<int> root_bending = {};
  std::vector<Leg> legs = {};  ///< each can support the robot alone, elastic or not
  /// Whether the robot stands on `legs`. If false, the legs only end in links that are observed,
  /// and the root link is held still.
  bool stands_on_legs = true;
  bool base = true;          ///< legs have a lumped compliance from foot to waist, eq. 6
  bool torque_bias = false;  ///< with `base`, the legs' torque sensors have unknown biases
  /// Corrections (corrections.hpp). One of a joint is a parameter if its joint moves a marker. One
  /// of loads is a parameter if a joint that carries the body is elastic and the root link stands
  /// still and does not bend; for a robot on its legs, the loads of the legs are not known.
  std::vector<Correction> corrections = {};
};

/// The robot with its markers and the named errors that can be estimated (paper section 2.1). Only
/// joints that move a marker or the foot of a support leg have parameters: to get the model of one
/// chain, select its markers.
struct ErrorModel {
  RobotTree tree;
  std::vector<JointPlacement> placements;  ///< one for each joint of the tree
  std::vector<Marker> markers;
  Transform T_ref_waist = Transform::Identity();  ///< nominal pose of the root link, eq. 2
  Elasticity elasticity;                          ///< as given to MakeErrorModel
  std::vector<SupportLeg> legs;                   ///< those of `elasticity`, with their joints
  std::vector<int> active_joints;                 ///< joints that have parameters, ascending
  /// The parameters, in this order:
  /// - T0, then corrections of the root link and of loads;
  /// - joints from the waist outwards, each with its geometric parameters, then compliance_z, _x,
  ///   _y, _root_x, _root_y, _root_z, then its corrections;
  /// - if Elasticity::base, legs, each with six compliances and then torque biases;
  /// - linkages of active joints;
  /// - corrections of markers, then the positions of the markers.
  std::vector<Parameter> parameters;

  int parameter_count() const { return static_cast<int>(parameters.size()); }
  int marker_count() const { return static_cast<int>(markers.size()); }
  int leg_count() const { return static_cast<int>(legs.size()); }
};

/// Places the joints and names the parameters. Throws std::invalid_argument if two markers or two
/// legs share a name; if a marker's link, a leg's link or a joint does not exist in the tree; if a
/// leg has no joints; or if a prismatic joint is to bend.
ErrorModel MakeErrorModel(RobotTree tree, std::vector<Marker> markers,
                          const PlacementOptions& options = {}, const Elasticity& elasticity = {});

/// The same model with only the markers of the given names, in that order; legs and elasticity
/// stay. Throws InputError with the nearest known name for an unknown name, and
/// std::invalid_argument for a name given twice.
ErrorModel SelectMarkers(const ErrorModel& model, const std::vector<std::string>& names);

/// Errors by the names of their parameters.
std::map<std::string, double> NamedErrors(const ErrorModel& model, const Eigen::VectorXd& errors);

/// Vector of errors of the model: for each parameter the entry of `named` with its name, or 0. The
/// errors of one model of a robot become those of a larger one by ErrorsByName(larger,
/// NamedErrors(model, errors)).
Eigen::VectorXd ErrorsByName(const ErrorModel& model, const std::map<std::string, double>& named);

}  // namespace elastocal
