// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "elastocal/math/transform.hpp"
#include "elastocal/robot/linkage.hpp"

namespace elastocal {

class Random;

/// Limits of a joint in rad, rad/s and N.m, or in m, m/s and N for a prismatic joint. Infinite if
/// the URDF gives none.
struct JointLimits {
  double lower, upper, velocity, effort;
};

enum class JointType { kRevolute, kPrismatic };

/// How an entry of the position vector q moves a joint.
struct Drive {
  int coordinate = 0;
  double multiplier = 1.0;
};

/// A movable joint. It moves the body of the same index plus one: joint k moves body k + 1.
struct Joint {
  std::string name;
  JointType type = JointType::kRevolute;
  int parent_link = 0, child_link = 0;  ///< links of the URDF
  int parent_body = 0;                  ///< body the joint is mounted on
  Transform T_parent_child;             ///< URDF origin: parent link to child link at position 0
  Eigen::Vector3d axis;                 ///< unit vector in the child link's frame
  JointLimits limits;
  /// Entry of the position vector q that drives the joint; position = multiplier * q + offset.
  /// A mimic joint shares the entry of the joint it follows; all others have (1, 0).
  int coordinate = 0;
  double multiplier = 1.0, offset = 0.0;
  bool mimic = false;            ///< its position is that of others: it has no entry of its own
  std::vector<Drive> more = {};  ///< further entries of q that move a coupled joint, added up
};

/// A link of the URDF. Links joined by fixed joints form one body.
struct Link {
  std::string name;
  int body = 0;
  Transform
      T_body_link;  ///< the body's frame is that of the link its joint moves (root: the root link)
  double mass = 0.0;                              ///< kg
  Eigen::Vector3d com = Eigen::Vector3d::Zero();  ///< centre of mass in the link's frame, m
  Eigen::Matrix3d inertia =
      Eigen::Matrix3d::Zero();  ///< about the centre of mass, link's axes, kg.m^2
};

/// A robot as a tree of bodies joined by revolute and prismatic joints, as a URDF describes it.
/// Body 0 is the root (the waist of a humanoid). Every joint comes after those that carry it;
/// otherwise joints are in the order of the file.
struct RobotTree {
  std::string name;
  std::vector<Link> links;  ///< links[0] is the root link
  std::vector<Joint> joints;
  std::vector<int> coordinate_joint;  ///< for each entry of q, its joint
  std::vector<Linkage> linkages;      ///< joints that motors move by rods: see AddLinkage
  /// Sentences about what the description leaves open or says oddly, and how it was read.
  std::vector<std::string> warnings;

  int body_count() const { return static_cast<int>(joints.size()) + 1; }
  int coordinate_count() const { return static_cast<int>(coordinate_joint.size()); }
};

/// Index of a link or joint. Throws InputError with the nearest known name if there is none of that
/// name.
int FindLink(const RobotTree& tree, const std::string& name);
int FindJoint(const RobotTree& tree, const std::string& name);

/// All entries of q that move a joint, with their factors.
std::vector<Drive> DrivesOf(const Joint& joint);

/// Whether an entry of q, or one of several, moves the joint.
bool IsMovedBy(const Joint& joint, int coordinate);
bool IsMovedBy(const Joint& joint, const std::vector<int>& coordinates);

/// Velocity (acceleration) of a joint for the velocity (acceleration) `q_rate` of q.
double JointRate(const Joint& joint, const Eigen::VectorXd& q_rate);

/// Adds a joint's torque [N.m or N] to those of the entries of q that move it.
void AddTorque(const Joint& joint, double torque, Eigen::VectorXd& torques);

/// Position of a joint [rad or m] for the position vector `q` of the whole tree.
double JointPosition(const Joint& joint, const Eigen::VectorXd& q);

/// Pose of the body that joint `joint` moves in the frame of the body it is mounted on, straight
/// from the URDF's origin and axis.
Transform ParentBodyToChild(const RobotTree& tree, int joint, const Eigen::VectorXd& q);

/// Poses of all links, from those of the bodies.
std::vector<Transform> LinkTransforms(const RobotTree& tree,
                                      const std::vector<Transform>& T_ref_body);

/// Pose of every link in the root link's frame, straight from the URDF's own origins and axes.
std::vector<Transform> LinkTransforms(const RobotTree& tree, const Eigen::VectorXd& q);

/// Joints from the root to a body, in this order.
std::vector<int> JointsToBody(const RobotTree& tree, int body);

/// Size of the robot: twice the sum of the offsets along its longest branch, m. No two points of
/// the robot are much further apart.
double RobotSize(const RobotTree& tree);

/// Range of a joint's positions in postures, rad or m. It is given by the joint's limits, or half a
/// turn (0.5 m) to either side of zero where it has none. If the limits are further apart than one
/// turn (motors that count turns), the range is one turn whose middle is as near to `around` as the
/// limits allow, so that no posture occurs twice. A share `margin` of the range is left free at
/// either end.
std::pair<double, double> PostureRange(const Joint& joint, double margin = 0.0,
                                       double around = 0.0);

/// A posture drawn uniformly within PostureRange, of size `coordinate_count()`. It is drawn again,
/// up to 1000 times, until the linkages close.
Eigen::VectorXd RandomPosture(const RobotTree& tree, Random& random);

}  // namespace elastocal
