// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "elastocal/runtime/core_poses.h"
#include "elastocal/runtime/runtime_model.hpp"

namespace elastocal {

struct CompensatorOptions {
  /// Time constant of the low-pass on torques that are given, s, and the interval between calls, s.
  /// Measured torques of fast motion hold more than the load that deflects the robot, and would
  /// overcompensate (paper, section 7). 0: no filter, for torques of a plan.
  double torque_time_constant_s = 0.0;
  double period_s = 1e-3;
  /// Limits, so that no input gives a wild command. What is beyond is cut and reported.
  double largest_turn_rad = 0.05;        ///< of each elastic rotation
  double largest_shift_m = 0.02;         ///< of each elastic translation
  double largest_correction_rad = 0.25;  ///< of a joint (m for a prismatic joint) from nominal
};

/// The feet that stand: bit i for foot i of the model. 0: the root link is held.
using StandingFeet = unsigned;

/// What a call has to say about itself: bits EC_... of core_poses.h, 0 is fine.
using CompensatorStatus = unsigned;

/// In words, "; " between them; empty for 0. Allocates: not for the control loop.
std::string DescribeStatus(CompensatorStatus status);

/// A calibrated elastic robot for a controller: where it really is, and what to command so that it
/// goes where the nominal robot would. After construction nothing allocates, locks or throws, and
/// the work of a call is bounded by the size of the robot. An object serves one thread.
///
/// Positions are by coordinate (RuntimeModel::coordinate_names), rad or m, as encoders give them.
/// Torques are by joint (joint_names), N.m or N, as sensors report them, which balance the load; an
/// empty vector stands for none: loads then follow from statics. Torques of NaN are not known:
/// statics takes their place until a first value comes, and then the last value.
///
/// A joint with hysteresis lies on the side of its play from which it came: in the middle at first,
/// then by the positions of earlier calls, measured ones (Forward, Correct) and planned ones
/// (Command) each by themselves. So they come in the order in which the robot was there.
///
/// Bad input never gives a wild command. Positions that are not finite, or of another number, are
/// replaced by the last good ones, an unknown foot by the last good support, and the status says
/// so.
class Compensator {
 public:
  /// Throws std::invalid_argument for a model without joints or with more than 32 feet, and for
  /// options that are not positive.
  explicit Compensator(RuntimeModel model, const CompensatorOptions& options = {});
  Compensator(Compensator&&) = default;
  Compensator& operator=(Compensator&&) = delete;
  Compensator(const Compensator&) = delete;
  Compensator& operator=(const Compensator&) = delete;
  ~Compensator() = default;

  const RuntimeModel& model() const noexcept { return model_; }

  /// The next Command is found from its plan alone, as the first one is: for a motion that starts
  /// anew. Joints with hysteresis stay on the side of their play on which they lie.
  void Forget() noexcept;

  /// From now on the commands of calls along a motion (see Command) change by at most so much from
  /// one call to the next, by coordinate, rad or m: the largest speed of a joint times the time
  /// between calls. Beside the plan a joint moves by at most a tenth of that. A joint that the plan
  /// itself moves further moves as far as the plan does. An
  /// entry that is negative or not a number is no limit, and an empty vector has none.
  void LimitChanges(const Eigen::Ref<const Eigen::VectorXd>& most) noexcept;

  /// From now on the corrections of calls along a motion start and end gently. From rest to the
  /// largest speed beside the plan, a tenth of what LimitChanges says (a joint without such a limit
  /// has none here), takes so many calls, and so does braking. So the acceleration of a command
  /// beside the plan is bounded, and near a stretched limb, where the best command starts and stops
  /// within one call, more is left for some calls. Limits of joints and of their speed are kept
  /// first. 0: the best command is given as it is. A call that stands by itself, and one with other
  /// feet, goes there at once.
  void EaseChanges(double calls) noexcept;

  /// Forward kinematics with deflection (eq. 3, 5, 6): fills link_pose() and root_pose().
  CompensatorStatus Forward(const Eigen::Ref<const Eigen::VectorXd>& q,
                            const Eigen::Ref<const Eigen::VectorXd>& torque,
                            StandingFeet feet) noexcept;

  /// The positions with which a rigid robot of calibrated geometry has hands and feet where the
  /// real one has them at `q`: rigid_positions(), for kinematics with the URDF of `elastocal export
  /// --format urdf --beside-springs`. And how far the real root link is from that of
  /// the rigid robot at `q` on the same feet: root_displacement().
  CompensatorStatus Correct(const Eigen::Ref<const Eigen::VectorXd>& q,
                            const Eigen::Ref<const Eigen::VectorXd>& torque,
                            StandingFeet feet) noexcept;

  /// Commands with which hands, feet and waist are where the nominal robot has them at
  /// `nominal`: command(). They are within the limits of the joints: what one cannot do, others
  /// take over. A joint of `nominal` that is beyond its limit stays there, and gets no further.
  /// Where that is not enough the command is the best nearby, and that of a call by itself never
  /// worse than `nominal` as it is. What is left is in residual_m() and residual_rad(), and why in
  /// stopped().
  ///
  /// Calls along a motion stay at one solution: while no joint of `nominal` is further than 0.1
  /// (rad, m) from the last call, the search starts from the last correction. If the same feet
  /// stand, and torques are given as then or not, a joint moves as `nominal` does or less, and
  /// beside that by at most the largest change of `nominal` and 0.2 mrad (a slide: 0.1 m for each
  /// radian of that). Where that keeps the end of a limb from its place, more is left,
  /// EC_CORRECTION_CUT says so, and it can be more than `nominal` itself would leave. See Forget().
  CompensatorStatus Command(const Eigen::Ref<const Eigen::VectorXd>& nominal,
                            const Eigen::Ref<const Eigen::VectorXd>& torque,
                            StandingFeet feet) noexcept;

  /// The same for wanted poses of the ends of the limbs, in the root link's frame, by tip of the
  /// model (array of tip_names.size()). `nominal` is a posture nearby, from which redundant joints
  /// do not stray.
  CompensatorStatus Command(const Eigen::Isometry3d* T_root_tip,
                            const Eigen::Ref<const Eigen::VectorXd>& nominal,
                            const Eigen::Ref<const Eigen::VectorXd>& torque,
                            StandingFeet feet) noexcept;

  /// Of the last Forward: pose of a link in the root link's frame, and of the root link in the
  /// frame of the first foot that stands (identity while the root link is held), by the leg between
  /// the two. How other feet stand against it, the poses say: nothing is taken from the nominal
  /// robot.
  Eigen::Isometry3d link_pose(int link) const noexcept;
  Eigen::Isometry3d root_pose() const noexcept;

  /// Of the last Correct. The displacement is a translation of the root link's origin [m], then a
  /// rotation vector [rad], in the axes of the first foot that stands.
  const Eigen::VectorXd& rigid_positions() const noexcept { return rigid_; }
  const Eigen::Matrix<double, 6, 1>& root_displacement() const noexcept { return displacement_; }

  /// Of the last Command. What is left is that of limbs that do not yield (ec_tip).
  const Eigen::VectorXd& command() const noexcept { return command_; }
  double residual_m() const noexcept { return residual_[0]; }
  double residual_rad() const noexcept { return residual_[1]; }

  /// Of the last Command, by coordinate: EC_JOINT_LIMIT or EC_CORRECTION_CUT (of the correction's
  /// size, or of its change from the last one) where this limit keeps
  /// the end of a limb from its place, by 0.2 mm or more; else 0.
  const std::vector<unsigned>& stopped() const noexcept { return stopped_; }

  /// Of the last Command: the largest error that is left at the ends of the limbs that a coordinate
  /// can move, m; an angle counts as its displacement at 0.3 m (ec_tip::arm). 0 for one that moves
  /// none.
  double left_m(int coordinate) const noexcept;

  /// Of the last Command: what is left at the end of a limb, by tip of the model, m; an angle
  /// counts as its displacement at 0.3 m (ec_tip::arm). Until another function is called.
  double tip_left_m(int tip) const noexcept;

  /// The same robot for the functions of core_correction.h.
  const ec_robot& robot() const noexcept { return robot_; }

 private:
  const double* Positions(const Eigen::Ref<const Eigen::VectorXd>& q) const noexcept;
  const double* Torques(const Eigen::Ref<const Eigen::VectorXd>& torque) const noexcept;
  void Link(const RuntimeBranches& branches, const CompensatorOptions& options);
  void Allocate();

  RuntimeModel model_;
  RuntimeBranches branches_;
  ec_robot robot_{};
  ec_memory memory_{};
  std::vector<double> numbers_, not_finite_;
  std::vector<ec_pose> poses_;
  std::vector<int> whole_;
  std::vector<ec_search> search_;
  std::vector<unsigned> stopped_;
  ec_pose root_{};
  ec_pose* links_ = nullptr;
  ec_pose* wanted_ = nullptr;
  Eigen::VectorXd rigid_, command_;
  Eigen::Matrix<double, 6, 1> displacement_ = Eigen::Matrix<double, 6, 1>::Zero();
  double residual_[2] = {0.0, 0.0};
};

}  // namespace elastocal
