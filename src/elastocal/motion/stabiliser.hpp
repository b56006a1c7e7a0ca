#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/motion/leg_chain.hpp"
#include "elastocal/robot/standing.hpp"

namespace elastocal {

/// What a robot that stands feels.
struct StandingSense {
  /// Of the inertial unit in the root link; what it says of the heading is not used.
  Eigen::Matrix3d R_world_root = Eigen::Matrix3d::Identity();
  /// Of the force sensors in the feet, a column a sole: what the floor exerts on it, force [N] and
  /// moment about the sole's origin [N.m], in the sole's axes.
  Eigen::Matrix<double, 6, Eigen::Dynamic> wrenches;
};

/// How fast a stabiliser learns. Slower than a robot on its feet sways (some 3 rad/s), else it
/// rocks from foot to foot.
struct StabiliserOptions {
  double turn_rate = 0.8;       ///< of the root link against its inclination's error, 1/s
  double shift_rate = 0.3;      ///< of the root link against the pressed point's error, 1/s
  double foot_rate = 0.2;       ///< of two feet against each other's pressed points, rad/s per m
  double filter_s = 0.5;        ///< time constant of the low-pass on the pressed point
  double largest_shift = 0.10;  ///< m, in either direction
  double largest_turn = 0.15;   ///< rad, about either axis, of root link and feet
  double largest_speed = 0.3;   ///< of a joint's correction, rad/s
  /// Planned heights of a lifted sole over the floor up to which its leg is corrected as if it
  /// stood, and from which it goes as planned, m.
  double low_m = 0.02, high_m = 0.07;
  double least_pressure = 100.0;  ///< N: what is pressed less tells nothing of where
};

/// What keeps a robot with unknown errors over its feet. Slowly, by integrating what it feels, it
/// - turns the root link until that is as upright as planned,
/// - turns two standing feet against each other until both are flat on the floor, pressed at like
///   points (a foot on its edge lets the robot rock, and the pressed point no longer tells where
///   the weight is),
/// - shifts the root link until the floor presses where the planned centre of mass is.
/// It knows of the robot what its description says, errors and elasticity not included, and takes
/// the planned positions to be those of a robot at rest. The paper's robot has one of its own
/// (section 3.6 plans for it).
class Stabiliser {
 public:
  /// Keeps a reference to the tree. Throws InputError where a sole hangs on no leg of six joints.
  Stabiliser(const RobotTree& tree, const std::vector<Sole>& soles,
             const StabiliserOptions& options = {});

  /// The planned posture, by coordinate, with the legs moved by what was learned until now and in
  /// the `interval_s` before; `support`: links of the soles that are planned to stand. A leg that
  /// cannot reach keeps the correction that it had.
  Eigen::VectorXd Correct(const Eigen::VectorXd& planned, const std::vector<int>& support,
                          const StandingSense& sense, double interval_s);

  const Eigen::Vector2d& shift() const { return shift_; }  ///< of the root link, m
  const Eigen::Vector2d& turn() const { return turn_; }    ///< of the root link, rad

 private:
  void StandOn(int reference);
  void LearnTurn(const StandingSense& sense, double interval_s);
  void LearnFeet(const StandingSense& sense, double interval_s);
  void LearnShift(const Eigen::VectorXd& planned, const StandingSense& sense, double interval_s);
  Eigen::VectorXd Corrected(const Eigen::VectorXd& planned) const;

  const RobotTree& tree_;
  StabiliserOptions options_;
  std::vector<BodyInertia> inertias_;
  std::vector<LegChain> legs_;          ///< by sole
  std::vector<Transform> T_root_sole_;  ///< as planned
  int reference_ = 0;                   ///< the sole in whose axes turn and shift are
  Eigen::Vector2d shift_ = Eigen::Vector2d::Zero(), turn_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d off_ = Eigen::Vector2d::Zero();   ///< filtered error of the pressed point, m
  Eigen::Vector2d foot_ = Eigen::Vector2d::Zero();  ///< turn of the first of two soles, rad
  Eigen::VectorXd correction_;                      ///< of the joints
};

}  // namespace elastocal
