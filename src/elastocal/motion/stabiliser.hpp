// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/motion/leg_chain.hpp"
#include "elastocal/robot/standing.hpp"

namespace elastocal {

/// Measurements of the balance sensors of a standing robot.
struct StandingSense {
  /// Orientation by the inertial unit in the root link; its heading is not used.
  Eigen::Matrix3d R_world_root = Eigen::Matrix3d::Identity();
  /// Wrenches by the force sensors in the feet, one column for each sole: the force [N] that the
  /// floor exerts on it, and the moment about the sole's origin [N.m], in the sole's axes.
  Eigen::Matrix<double, 6, Eigen::Dynamic> wrenches;
};

/// How fast a stabiliser corrects. It must be slower than the sway of the robot on its feet, whose
/// natural frequency is sqrt(g / l) with the leg's length l (about 3 rad/s for a robot of a man's
/// size), or the robot rocks from foot to foot. Rates are shares of that frequency and lengths are
/// shares of l, so that robots of every size are treated alike.
struct StabiliserOptions {
  double turn_rate = 0.24;   ///< turn of the root link by the error of its inclination
  double shift_rate = 0.18;  ///< shift of the root link by the error of the zero-moment point
  /// Turn of two feet by the difference of their centres of pressure, rad/s per length of a leg.
  double foot_rate = 0.16;
  /// Turn of the line between two feet by the load's mean distance from their middles, rad/s per
  /// length of a leg.
  double height_rate = 0.16;
  double filter_s = 0.5;        ///< time constant of the low-pass on the zero-moment point
  double largest_shift = 0.12;  ///< share, in either direction
  double largest_turn = 0.15;   ///< rad, about either axis, of root link and feet
  double largest_speed = 0.3;   ///< largest speed of a joint's correction, rad/s
  /// The correction of a lifted leg fades out between these planned heights of its sole over the
  /// floor, as shares: below the first, the leg is corrected as if it stood; above the second, it
  /// goes as planned.
  double low = 0.025, high = 0.085;
  double least_pressure = 0.1;  ///< least vertical force that gives a centre of pressure, of weight
};

/// Keeps a robot with unknown errors over its feet. By slow integration of its measurements it
/// - turns the root link until that is as upright as planned,
/// - turns two standing feet against each other until both are flat on the floor, with their
///   centres of pressure at like points (a foot on its edge lets the robot rock, and its centre of
///   pressure no longer tells where the weight is),
/// - shifts the root link until the zero-moment point is where the planned centre of mass is.
/// Feet are turned only if there are two of them and they are not balls; the root link is turned
/// and shifted in any case.
/// Turn and shift are learned for each foot in proportion to its planned share of the weight,
/// because every leg has errors of its own. What was learned on a foot is used again when the
/// weight comes back to it. The stabiliser knows the robot by its description, without errors and
/// elasticity, and treats planned positions as those of a robot at rest. A caller whose robot is
/// known to stand as planned calls TakeRest; otherwise errors of the described masses make the
/// stabiliser move a root link that is right. The paper's robot has its own stabiliser, for which
/// section 3.6 plans.
class Stabiliser {
 public:
  /// Keeps a reference to the tree. Throws InputError if a sole is not at the end of a leg
  /// (see LegChain).
  Stabiliser(const RobotTree& tree, const std::vector<Sole>& soles,
             const StabiliserOptions& options = {});

  /// Updates the correction by the measurements of the last `interval_s` and returns the planned
  /// posture, by coordinate, with the legs corrected. `support` has the links of the soles that are
  /// planned to stand. A leg that cannot reach its target keeps the correction that it had.
  Eigen::VectorXd Correct(const Eigen::VectorXd& planned, const std::vector<int>& support,
                          const StandingSense& sense, double interval_s);

  /// Learns the error of the described masses from a robot that is known to stand as planned, at
  /// rest. The distance of its zero-moment point from the planned centre of mass is from then on
  /// treated as an error of the centre of mass that moves with the root link, and not as a reason
  /// to shift.
  void TakeRest(const Eigen::VectorXd& planned, const std::vector<int>& support,
                const StandingSense& sense);

  const Eigen::Vector2d& shift() const { return shift_; }  ///< of the root link, m
  const Eigen::Vector2d& turn() const { return turn_; }    ///< of the root link, rad

 private:
  /// The planned poses of the soles in the root link's frame. A ball gets the axes of the floor on
  /// which balls are planned to stand, z up and x ahead.
  void PlaceSoles(const Eigen::VectorXd& planned, const std::vector<int>& support);
  /// The wrenches in the axes of T_root_sole_.
  StandingSense InSoleAxes(const Eigen::VectorXd& planned, const StandingSense& sense) const;
  void StandOn(int reference);
  void ShareWeight(const Eigen::VectorXd& planned, const std::vector<int>& support);
  /// Mean of what was learned for the soles, weighted by their shares of the weight, in the axes of
  /// the reference sole.
  Eigen::Vector2d Blend(const std::vector<Eigen::Vector2d>& by_sole) const;
  /// Changes what was learned so that its blend changes by `change`.
  void Learn(const Eigen::Vector2d& change, double largest, std::vector<Eigen::Vector2d>& by_sole);
  void LearnTurn(const StandingSense& sense, double interval_s);
  bool BothPressed(const StandingSense& sense) const;
  void LearnFeet(const StandingSense& sense, double interval_s);
  void LearnHeight(const StandingSense& sense, double interval_s);
  /// Zero-moment point less planned centre of mass, in the axes of the reference sole, m; nothing
  /// if the feet are hardly pressed.
  std::optional<Eigen::Vector2d> Off(const Eigen::VectorXd& planned,
                                     const StandingSense& sense) const;
  void LearnShift(const Eigen::VectorXd& planned, const StandingSense& sense, double interval_s);
  Eigen::VectorXd Corrected(const Eigen::VectorXd& planned) const;

  const RobotTree& tree_;
  StabiliserOptions options_;
  std::vector<BodyInertia> inertias_;
  std::vector<LegChain> legs_;              ///< by sole
  std::vector<Eigen::Vector2d> middle_;     ///< of the soles, in their axes, m
  double leg_length_ = 1.0, weight_ = 0.0;  ///< m, N
  double frequency_ = 1.0;                  ///< of the sway, rad/s
  /// Displacement of the centre of mass from the described one, in the root link's axes, m.
  Eigen::Vector3d com_off_ = Eigen::Vector3d::Zero();
  std::vector<Transform> T_root_sole_;  ///< as planned
  int reference_ = 0;                   ///< the sole in whose axes turn and shift are expressed
  Eigen::VectorXd share_;               ///< of the planned weight, by sole
  std::vector<Eigen::Vector2d> shifts_, turns_;  ///< by sole, in its axes
  Eigen::Vector2d shift_ = Eigen::Vector2d::Zero(), turn_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d off_ = Eigen::Vector2d::Zero();   ///< filtered error of the zero-moment point, m
  Eigen::Vector2d foot_ = Eigen::Vector2d::Zero();  ///< turn of the first of two soles, rad
  double height_ = 0.0;                             ///< of the first of two soles over the other, m
  Eigen::VectorXd correction_;                      ///< corrections of the joints, rad
};

}  // namespace elastocal
