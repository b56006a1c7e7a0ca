// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include <Eigen/Geometry>
#include <mujoco/mujoco.h>

namespace elastocal {

/// MuJoCo's results for a URDF, for comparison: kinematics, point Jacobians and gravity torques, by
/// the URDF's names. It shares no code with the library.
///
/// MuJoCo's URDF reader welds the root link to the world and drops its mass. So a floating joint,
/// which stays at the identity, joins the root to a link `world`: the frame of the root link is the
/// world's. Constraints (limits, contacts) and passive forces (damping) are disabled.
///
/// MuJoCo 2.2.2 has no mimic joints. Each of them is a joint of its own here, so that the caller
/// sets its position and sums its torque or Jacobian column by the chain rule.
class MujocoOracle {
 public:
  /// Throws std::runtime_error with MuJoCo's message if it refuses the file.
  MujocoOracle(const std::filesystem::path& urdf, const std::string& root_link);

  /// Sets the position of a joint, rad or m. Call `Update` after the last one.
  void SetPosition(const std::string& joint, double position);
  /// Sets the acceleration of gravity in the root link's frame, m/s^2. Call `Update` afterwards.
  void SetGravity(const Eigen::Vector3d& gravity);
  /// Evaluates the model at rest.
  void Update();

  /// Pose of a link in the root link's frame.
  Eigen::Isometry3d LinkPose(const std::string& link) const;
  /// Torque (or force) by which the joint's motor holds the robot still, N.m or N.
  double GravityTorque(const std::string& joint) const;
  /// The same torque while the robot stands on `fixed_link` alone, which is welded to the floor.
  double StandingTorque(const std::string& joint, const std::string& fixed_link) const;
  /// Derivative of a point fixed to a link [its position in the root's frame, m] with respect to
  /// the position of a joint.
  Eigen::Vector3d PointDerivative(const std::string& joint, const std::string& link,
                                  const Eigen::Vector3d& p_root_point) const;
  double TotalMass() const;
  /// Inertia of a link about its centre of mass in the link's axes, as MuJoCo stores it: by
  /// principal moments and axes, which are accurate to about six digits.
  Eigen::Matrix3d LinkInertia(const std::string& link) const;

  /// Sets the motion of the root link in the world (velocity and acceleration of its origin,
  /// angular ones in the world's axes) or of a joint. `UpdateInverse` evaluates mj_inverse.
  void SetRootMotion(const Eigen::Isometry3d& T_world_root, const Eigen::Vector3d& velocity,
                     const Eigen::Vector3d& turn, const Eigen::Vector3d& acceleration,
                     const Eigen::Vector3d& turn_rate);
  void SetMotion(const std::string& joint, double position, double velocity, double acceleration);
  void UpdateInverse();
  double InverseTorque(const std::string& joint) const;
  /// Force on the root link and moment about its origin, in the world's axes.
  Eigen::Vector3d InverseForce() const;
  Eigen::Vector3d InverseMoment() const;

  /// Access for benchmarks.
  const mjModel* model() const { return model_.get(); }
  mjData* data() { return data_.get(); }
  int LinkId(const std::string& link) const;

 private:
  int JointId(const std::string& joint) const;

  std::unique_ptr<mjModel, decltype(&mj_deleteModel)> model_;
  std::unique_ptr<mjData, decltype(&mj_deleteData)> data_;
};

}  // namespace elastocal
