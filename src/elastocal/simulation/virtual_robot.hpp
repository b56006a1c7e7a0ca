// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "elastocal/simulation/mjcf.hpp"

namespace elastocal {

/// A true robot that stands in MuJoCo's world (z up) and moves by its dynamics: joints with servos,
/// springs, friction and gravity. It is commanded and read like a real one.
class VirtualRobot {
 public:
  /// Puts the robot down on `support` (links of feet; if empty, the waist is held still) in the
  /// posture `encoders` (by coordinate), with no load on its springs. Throws what BuildMjcf throws,
  /// and std::runtime_error with MuJoCo's message if it does not accept the model.
  VirtualRobot(const TrueRobot& robot, const std::vector<int>& support,
               const Eigen::VectorXd& encoders, const PhysicsOptions& options = {},
               const std::vector<PhysicalPlate>& plates = {});
  ~VirtualRobot();
  VirtualRobot(VirtualRobot&&) noexcept;

  double time_step_s() const;

  /// Sets the encoder positions that the servos follow from now on, by coordinate, rad or m.
  void Command(const Eigen::VectorXd& encoders);
  /// Takes one time step.
  void Step();
  /// Steps until all is at rest (no speed above 1e-7 rad/s or m/s in the springs) or `longest_s`
  /// has passed. Returns whether it rests.
  bool Settle(double longest_s = 10.0);

  /// Applies a wrench to the root link [N, N.m], at its origin, in the world's axes, until the next
  /// call.
  void PushWaist(const Vector6d& wrench);

  /// By joint, the exact encoder positions (before quantisation), rad or m, and the torques of the
  /// drives, which balance the load, N.m or N.
  Eigen::VectorXd Encoders() const;
  Eigen::VectorXd Torques() const;

  /// Height of a part that is high while the robot stands, m: the root link, or the hips if the
  /// root link is a frame on the floor.
  double Height() const;
  /// Whether Height() is at most 70 % of the `height` that it had at rest, or the robot is
  /// Unstable.
  bool FallenFrom(double height) const;
  /// Whether the simulation has diverged, after which MuJoCo starts anew.
  bool Unstable() const;

  Transform WaistPose() const;         ///< of the root link in the world
  Transform LinkPose(int link) const;  ///< of any link of the tree
  /// Pose of a sole in `support`. It differs from its link's pose by the deflection between ankle
  /// and sole.
  Transform SolePose(int index) const;
  Eigen::Matrix3Xd MarkerPositions() const;  ///< in the world, m
  /// Force [N] that the floor exerts on freely standing soles, and its moment about the world's
  /// origin [N.m], in the world's axes.
  std::pair<Eigen::Vector3d, Eigen::Vector3d> FloorWrench() const;
  /// The same for one sole in `support` alone: force, and moment about its origin, in its axes, as
  /// a force sensor in the foot measures them.
  Vector6d SoleWrench(int index) const;
  /// Puts the table of a plate at a pose; its plane is z = 0 of its frame. Before the first call it
  /// is out of reach.
  void PlaceTable(int plate, const Transform& T_world_table);
  Transform PlatePose(int plate) const;  ///< of the middle of its face
  /// Force of the table on a plate and its moment about the middle of its face, in the axes of the
  /// face, N and N.m.
  Vector6d PlateWrench(int plate) const;
  int coordinate_count() const;  ///< of the simulation

 private:
  struct Simulation;
  std::unique_ptr<Simulation> simulation_;
};

}  // namespace elastocal
