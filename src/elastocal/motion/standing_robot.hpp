#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/motion/leg_chain.hpp"
#include "elastocal/robot/standing.hpp"

namespace elastocal {

/// Distances between the surfaces of parts that may meet, m, for a whole posture q; negative where
/// they overlap. Always of the same size; empty: nothing can meet.
using Clearances = std::function<Eigen::VectorXd(const Eigen::VectorXd& q)>;

/// What motions keep to, of each sample. Shares are of the limits in the URDF.
struct MotionLimits {
  double position_margin = 0.01;  ///< kept from either end of a joint's range, rad or m
  double velocity_share = 0.9, torque_share = 0.9;
  double clearance = 0.005;   ///< least distance between parts that may meet, m
  double zmp_margin = 0.020;  ///< of the zero-moment point to the edge of the support polygon, m
  double friction = 0.5;      ///< largest horizontal over vertical force of a foot
  double least_knee = 0.3;    ///< of a leg that stands, rad: how far its middle joints bend
};

/// A robot with its feet on a level floor, z = 0 of the world.
struct StandingRobot {
  RobotTree tree;
  std::vector<BodyInertia> inertias;
  std::vector<Sole> soles;     ///< of the feet, one or two
  std::vector<LegChain> legs;  ///< of these
  Clearances clearances;       ///< of its own parts; may be empty
  MotionLimits limits;
  /// The posture of rest, on all feet, balanced.
  Eigen::VectorXd rest;
  Transform T_world_root = Transform::Identity();  ///< in the posture of rest
  std::vector<Transform> T_world_sole;             ///< where the feet stand, by sole

  StandingRobot(const StandingRobot&) = delete;  // legs refer to the tree
  StandingRobot(RobotTree robot, std::vector<Sole> feet, const MotionLimits& kept);

  std::vector<int> AllFeet() const;
};

struct StandOptions {
  /// How much lower the waist is than over straight legs, as a share of its height, where the given
  /// posture has them straight.
  double drop = 0.07;
};

/// Stands the robot up in a posture (by coordinate): on the feet, which are flat, where they are
/// under the root link in the zero posture; the root link upright, as high above them as the
/// posture has it, or lower by the drop where its knees are less bent than the limits ask; and the
/// centre of mass over the middle of the support. Throws InputError where the legs cannot.
void StandUp(StandingRobot& robot, const Eigen::VectorXd& posture, const StandOptions& options);

/// The zero posture, moved inside the joints' limits by the position margin.
Eigen::VectorXd NeutralPosture(const RobotTree& tree, double position_margin);

/// Middle of what the given feet (indices of soles) stand on, m.
Eigen::Vector2d SupportCentre(const StandingRobot& robot, const std::vector<int>& feet);

/// A posture at rest with the root link where it is in the world.
struct PlacedPosture {
  Eigen::VectorXd q;
  Transform T_world_root = Transform::Identity();
};

/// Places the legs of `feet` so that their soles stand where they stand, with the root link moved
/// horizontally until the centre of mass is over `com`. Begins at `pose`. False, with the pose
/// changed, where a foot is out of reach.
bool BalanceAtRest(const StandingRobot& robot, const std::vector<int>& feet,
                   const Eigen::Vector2d& com, PlacedPosture& pose);

/// Places one leg so that its sole has the given pose in the world.
bool PlaceSole(const StandingRobot& robot, int foot, const Transform& T_world_sole,
               PlacedPosture& pose);

}  // namespace elastocal
