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
  /// Puts the robot down on `support` (links of feet; empty: the waist is held) in the posture
  /// `encoders` (by coordinate), everything unloaded. Throws what BuildMjcf throws, and
  /// std::runtime_error with MuJoCo's message where it does not take the model.
  VirtualRobot(const TrueRobot& robot, const std::vector<int>& support,
               const Eigen::VectorXd& encoders, const PhysicsOptions& options = {});
  ~VirtualRobot();
  VirtualRobot(VirtualRobot&&) noexcept;

  double time_step_s() const;

  /// What the servos follow from now on, encoder positions by coordinate, rad or m.
  void Command(const Eigen::VectorXd& encoders);
  /// One time step.
  void Step();
  /// Steps until all is at rest (no speed above 1e-7 rad/s or m/s in the springs) or `longest_s`
  /// has passed. Returns whether it rests.
  bool Settle(double longest_s = 10.0);

  /// A wrench on the root link [N, N.m], at its origin, in the world's axes, until the next one.
  void PushWaist(const Vector6d& wrench);

  /// By joint: what the encoders truly show (before quantisation), rad or m, and the torque that
  /// passes through the drive, as it balances the load, N.m or N.
  Eigen::VectorXd Encoders() const;
  Eigen::VectorXd Torques() const;

  Transform WaistPose() const;          ///< of the root link in the world
  Transform LinkPose(int link) const;   ///< of any link of the tree
  Transform SolePose(int index) const;  ///< of a sole in `support`; differs from its link's pose by
                                        ///< what the link between ankle and sole gives way
  Eigen::Matrix3Xd MarkerPositions() const;  ///< in the world, m
  /// What the floor exerts on soles that stand free: force, N, and moment about the world's origin,
  /// N.m, in the world's axes.
  std::pair<Eigen::Vector3d, Eigen::Vector3d> FloorWrench() const;
  /// The same of one sole in `support` alone: force, and moment about its origin, in its axes, as
  /// the force sensor of a foot shows it.
  Vector6d SoleWrench(int index) const;
  int coordinate_count() const;  ///< of the simulation

 private:
  struct Simulation;
  std::unique_ptr<Simulation> simulation_;
};

}  // namespace elastocal
