// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/motion/leg_chain.hpp"
#include "elastocal/robot/standing.hpp"

namespace elastocal {

/// Distances between the surfaces of parts that can touch, m, for a whole posture q; negative if
/// they overlap. The vector always has the same size; it is empty if no parts can touch.
using Clearances = std::function<Eigen::VectorXd(const Eigen::VectorXd& q)>;

/// Limits for each sample of a motion. Shares are of the limits in the URDF.
struct MotionLimits {
  double position_margin = 0.01;  ///< distance to either end of a joint's range, rad or m
  double velocity_share = 0.9, torque_share = 0.9;
  double clearance = 0.005;  ///< least distance between parts that can touch, m
  /// Least distance of the zero-moment point to the edge of the support polygon, m. Negative: three
  /// tenths of StandingRobot::half_support.
  double zmp_margin = -1.0;
  double friction = 0.5;     ///< largest ratio of horizontal to vertical force at a foot
  double least_knee = 0.3;   ///< least bend of the knee of a standing leg, rad
  double lever_share = 0.1;  ///< least LeverShare of linkages: away from their dead points
};

/// A robot with its feet on a level floor, z = 0 of the world, or a held robot: its root link is
/// held still at the world's origin (an arm, or a robot on a stand), it has no soles, and nothing
/// has to balance.
struct StandingRobot {
  RobotTree tree;
  std::vector<BodyInertia> inertias;
  std::vector<Sole> soles;     ///< of the feet; none: the root is held
  std::vector<LegChain> legs;  ///< one for each sole
  std::vector<int> knees;      ///< of each leg, the entry of q that is most bent in `rest`
  Clearances clearances;       ///< between its own parts; may be empty
  MotionLimits limits;         ///< with the margin of the zero-moment point in m
  /// The posture of rest: balanced on all feet.
  Eigen::VectorXd rest;
  Transform T_world_root = Transform::Identity();  ///< in the posture of rest
  /// Poses of the soles that stand on the floor; that of a ball has the attitude of the posture of
  /// rest.
  std::vector<Transform> T_world_sole;

  StandingRobot(const StandingRobot&) = delete;  // legs refer to the tree
  StandingRobot(RobotTree robot, std::vector<Sole> feet, const MotionLimits& kept);

  bool Held() const { return soles.empty(); }
  /// `leg_length`: length of a leg from its first joint to the sole along its joints, m.
  /// `half_support`: least distance from the middle of the support to its edge, over all supports
  /// on the fewest feet, m (half the width of the narrowest sole of a biped). Lengths of a motion
  /// are shares of these two. Both are 0 for a held robot.
  double leg_length = 0.0, half_support = 0.0;

  std::vector<int> AllFeet() const;
  /// All feet except `swings`, which is in the air.
  std::vector<int> AllFeetBut(int swings) const;
};

struct StandOptions {
  /// If the given posture has straight legs, the waist is lowered by this share of its height.
  double drop = 0.07;
  /// Distance between the centres of two soles, m; default: as in the zero posture.
  std::optional<double> stance;
};

/// Stands the robot up in a posture (by coordinate). The feet are flat and where they are under the
/// root link in the zero posture (balls: in the given one), or moved apart (together) along the
/// line of two centres to the stance. The root link is upright and as high above the feet as in the
/// posture, or lower by the drop if its knees are less bent than the limits require. The centre of
/// mass is over the middle of the support. A held robot rests in the posture itself. Throws
/// InputError if the legs cannot do this.
void StandUp(StandingRobot& robot, const Eigen::VectorXd& posture, const StandOptions& options);

/// The zero posture, moved inside the joints' limits by the position margin.
Eigen::VectorXd NeutralPosture(const RobotTree& tree, double position_margin);

/// Middle of the support of the given feet (indices of soles), m.
Eigen::Vector2d SupportCentre(const StandingRobot& robot, const std::vector<int>& feet);

/// A posture at rest, with the pose of the root link in the world.
struct PlacedPosture {
  Eigen::VectorXd q;
  Transform T_world_root = Transform::Identity();
};

/// Pose of the root link in the world in a posture with these feet where they stand: by the first
/// one if it is flat, by the places of all (three or more) if they are balls.
Transform RootOverFeet(const StandingRobot& robot, const std::vector<int>& feet,
                       const Eigen::VectorXd& q);

/// Pose of the root link in the world in a posture on all feet or on all but one: the first pose
/// for which the standing feet are where they stand (1 mm) and no foot is below the floor. If there
/// is none, the last foot is taken for the one in the air. For a held robot, the pose in which it
/// is held.
Transform RootOnFloor(const StandingRobot& robot, const Eigen::VectorXd& q);

/// Starting from `pose`, moves the root link horizontally until the centre of mass is over `com`,
/// and places the legs of `feet` so that their soles keep their place. Returns false, with the pose
/// changed, if a foot is out of reach.
bool BalanceAtRest(const StandingRobot& robot, const std::vector<int>& feet,
                   const Eigen::Vector2d& com, PlacedPosture& pose);

/// Places the legs of `feet` so that their soles stand where they stand on the floor. If legs
/// have too few joints of their own (see LegChain::turns_root), the first turns the root link about
/// the vertical, and the joint that they share moves until the second has its heading too. Returns
/// false, with the pose changed, if a foot is out of reach.
bool PlaceFeet(const StandingRobot& robot, const std::vector<int>& feet, PlacedPosture& pose);

/// Places one leg so that its sole has the given pose in the world. If the leg has too few joints
/// of its own, the sole may turn about its normal.
bool PlaceSole(const StandingRobot& robot, int foot, const Transform& T_world_sole,
               PlacedPosture& pose);

}  // namespace elastocal
