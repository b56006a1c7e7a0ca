// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "elastocal/runtime/core_poses.h"
#include "elastocal/runtime/runtime_model.hpp"

namespace elastocal {

/// Settings of a Compensator.
struct CompensatorOptions {
  /// Time constant of the low-pass filter on given torques, s, and the interval between calls, s.
  /// Measured torques of fast motion contain more than the load that deflects the robot, and would
  /// overcompensate (paper, section 7). 0: no filter, for planned torques.
  double torque_time_constant_s = 0.0;
  double period_s = 1e-3;
  /// Limits on corrections, so that no input gives a dangerous command. Larger values are cut and
  /// reported.
  double largest_turn_rad = 0.05;        ///< limit of each elastic rotation
  double largest_shift_m = 0.02;         ///< limit of each elastic translation
  double largest_correction_rad = 0.25;  ///< limit for a joint (m if prismatic) from nominal
};

/// The standing feet: bit i for foot i of the model. 0: the root link is held.
using StandingFeet = unsigned;

/// Status of a call: bits EC_... of core_poses.h; 0: no remarks.
using CompensatorStatus = unsigned;

/// A status as text, separated by "; "; empty for 0. Allocates, so that it must not be used in the
/// control loop.
std::string DescribeStatus(CompensatorStatus status);

/// A calibrated elastic robot for a controller. It computes where the robot really is, and which
/// positions to command so that it goes where the nominal robot would. After construction nothing
/// allocates, locks or throws, and the work of a call is bounded by the size of the robot. An
/// object serves one thread.
///
/// Positions are by coordinate (RuntimeModel::coordinate_names), rad or m, as measured by encoders.
/// Torques are by joint (joint_names), N.m or N, as reported by sensors, which balance the load. An
/// empty vector means no torques: loads then follow from statics. A torque of NaN is unknown:
/// statics replaces it until a first value comes, afterwards the last value does, and the status
/// says so. A call without torques forgets them: statics replaces one that is then not finite.
/// Forward, Correct and Command each have their own last positions, torques and feet.
///
/// A joint with hysteresis lies on the side of its play from which it came: in the middle at first,
/// then by the positions of earlier calls. Measured positions (Forward, Correct) and planned ones
/// (Command) are followed separately. Calls must therefore come in the order of the motion.
///
/// Invalid input never gives a dangerous command. Positions that are not finite, or of a wrong
/// number, are replaced by the last valid ones of the same function, and an unknown foot by its
/// last valid support; the status says so. Before any valid ones (EC_NOTHING_YET), a command is
/// that of StartFrom(), or else the zero posture, which no drive should be sent.
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

  /// Forgets the last command and all input: the next Command follows from its plan alone, like the
  /// first one. Joints with hysteresis stay on their side of the play. For calls that are no
  /// motion; a robot that moves begins again with StartFrom().
  void Forget() noexcept;

  /// Begins a motion from the command at which the drives are now, by coordinate: LimitChanges()
  /// holds from the next Command on, as if `command` had been given the call before for the same
  /// plan. Forgets what Forget() does. Returns false, and changes nothing, for a vector of a wrong
  /// size or with an entry that is not finite.
  bool StartFrom(const Eigen::Ref<const Eigen::VectorXd>& command) noexcept;

  /// Limits the changes of commands along a motion (see Command) from one call to the next, by
  /// coordinate, rad or m: the largest speed of a joint times the time between calls. A joint stays
  /// between where it was and where the plan goes from there, or leaves that by at most a tenth of
  /// the limit. A joint that the plan moves further moves as far as the plan does. (Where the plan
  /// jumps, see Command, only the limit itself holds.) A negative entry or NaN is no limit; an
  /// empty vector removes all limits. Returns false, and changes nothing, for another number of
  /// entries.
  bool LimitChanges(const Eigen::Ref<const Eigen::VectorXd>& most) noexcept;

  /// Eases the corrections along a motion. A correction takes `calls` calls to reach its largest
  /// speed (a tenth of the limit by LimitChanges; a joint without such a limit has none here), and
  /// as many to brake. This bounds the acceleration of commands relative to the plan. Near a
  /// stretched limb, where the best command starts and stops within one call, a larger deviation is
  /// left for some calls. Limits of positions and speeds of joints have priority. 0: the best
  /// command is given unchanged. A call that stands by itself, the first one after StartFrom(), or
  /// one with other feet or torques from elsewhere is not eased: LimitChanges() alone holds there.
  void EaseChanges(double calls) noexcept;

  /// Forward kinematics with deflection (eq. 3, 5, 6): fills link_pose() and root_pose().
  CompensatorStatus Forward(const Eigen::Ref<const Eigen::VectorXd>& q,
                            const Eigen::Ref<const Eigen::VectorXd>& torque,
                            StandingFeet feet) noexcept;

  /// Computes rigid_positions(): with these, a rigid robot of calibrated geometry has hands and
  /// feet where the real robot has them at `q`. They serve kinematics with the URDF of `elastocal
  /// export --format urdf --beside-springs`. Also computes root_displacement(): the displacement of
  /// the real root link from that of the rigid robot at `q` on the same feet.
  CompensatorStatus Correct(const Eigen::Ref<const Eigen::VectorXd>& q,
                            const Eigen::Ref<const Eigen::VectorXd>& torque,
                            StandingFeet feet) noexcept;

  /// Computes command(): joint positions with which hands, feet and waist are where the nominal
  /// robot has them at `nominal`. They are within the limits of the joints; what one joint cannot
  /// do, others take over. A joint of `nominal` beyond its limit stays there, and does not get
  /// further out. Where the limits do not suffice, the command is the best nearby; for a call by
  /// itself it is never worse than `nominal`. The remaining deviation is in residual_m() and
  /// residual_rad(), its cause in stopped().
  ///
  /// Calls along a motion keep to one solution: while no joint of `nominal` is further than 0.1
  /// (rad, m) from the last call, the search starts from the last correction. If the same feet
  /// stand, and torques are given in both calls or in neither, a joint moves at most as `nominal`
  /// does, plus the largest change of `nominal` and 0.2 mrad (prismatic joint: 0.1 m for each
  /// radian of that). If that keeps the end of a limb from its place, a larger deviation is left,
  /// possibly larger than that of `nominal` itself, and EC_CORRECTION_CUT is set. See Forget().
  CompensatorStatus Command(const Eigen::Ref<const Eigen::VectorXd>& nominal,
                            const Eigen::Ref<const Eigen::VectorXd>& torque,
                            StandingFeet feet) noexcept;

  /// As above, for wanted poses of the ends of limbs in the root link's frame, by tip of the model
  /// (array of tip_names.size()). `nominal` is a posture nearby, to which redundant joints stay
  /// close. Where a pose is not finite, or its matrix no rotation (to 5e-3), the status is
  /// EC_BAD_POSITION and the command that for `nominal`.
  CompensatorStatus Command(const Eigen::Isometry3d* T_root_tip,
                            const Eigen::Ref<const Eigen::VectorXd>& nominal,
                            const Eigen::Ref<const Eigen::VectorXd>& torque,
                            StandingFeet feet) noexcept;

  /// Results of the last Forward: pose of a link in the root link's frame, and pose of the root
  /// link in the frame of the first standing foot (identity while the root link is held), computed
  /// by the leg between the two. The poses also show how other feet stand relative to it; nothing
  /// is taken from the nominal robot.
  Eigen::Isometry3d link_pose(int link) const noexcept;
  Eigen::Isometry3d root_pose() const noexcept;

  /// Results of the last Correct. The displacement is a translation of the root link's origin [m],
  /// then a rotation vector [rad], in the axes of the first standing foot.
  const Eigen::VectorXd& rigid_positions() const noexcept { return rigid_; }
  const Eigen::Matrix<double, 6, 1>& root_displacement() const noexcept { return displacement_; }

  /// Results of the last Command. The residual is that of limbs that do not yield (ec_tip).
  const Eigen::VectorXd& command() const noexcept { return command_; }
  double residual_m() const noexcept { return residual_[0]; }
  double residual_rad() const noexcept { return residual_[1]; }

  /// By coordinate, for the last Command: the limit that keeps the end of a limb from its place by
  /// at least 0.2 mm. It is EC_JOINT_LIMIT, or EC_CORRECTION_CUT (limit of the correction's size,
  /// or of its change since the last call); else 0.
  const std::vector<unsigned>& stopped() const noexcept { return stopped_; }

  /// For the last Command: the largest deviation at the ends of limbs that a coordinate can move,
  /// m; an angle counts as its displacement at ec_tip::arm. 0 for a coordinate that moves none.
  double left_m(int coordinate) const noexcept;

  /// For the last Command: deviation at the end of a limb, by tip of the model, m; an angle counts
  /// as its displacement at ec_tip::arm. And the angle of it by itself, rad. Valid until another
  /// function is called.
  double tip_left_m(int tip) const noexcept;
  double tip_left_rad(int tip) const noexcept;

  /// The same robot as input of the functions in core_correction.h.
  const ec_robot& robot() const noexcept { return robot_; }

 private:
  const double* Positions(const Eigen::Ref<const Eigen::VectorXd>& q) const noexcept;
  const double* Torques(const Eigen::Ref<const Eigen::VectorXd>& torque) const noexcept;
  CompensatorStatus SizeStatus(const Eigen::Ref<const Eigen::VectorXd>& torque) const noexcept;
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
