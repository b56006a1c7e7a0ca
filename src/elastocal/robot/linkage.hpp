// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace elastocal {

struct RobotTree;

/// What of a rod can be in error. Lengths in m, kZero in rad.
enum class RodQuantity {
  kLength,  ///< between pin and anchor
  kZero,    ///< true position of the motor less the measured one
  kRadius,  ///< of the crank
  kAnchorX,
  kAnchorY,
  kAnchorZ,  ///< anchor on the link that is moved, in that link's axes
  kCentreX,
  kCentreY,
  kCentreZ,  ///< crank with its axis (or foot of an actuator), in the axes of its link
};

/// length, zero, radius, anchor_x ... centre_z
const char* RodQuantityName(RodQuantity quantity);

/// A quantity of a rod that is a parameter, and the standard deviation of its prior, m or rad.
struct RodUncertainty {
  RodQuantity quantity = RodQuantity::kLength;
  double sd = 1e-3;
};

/// A rod with a ball joint at either end, and the motor that drives it. The motor turns a crank, to
/// whose pin the rod goes; or the rod itself is a linear actuator, which the motor lengthens.
struct Rod {
  std::string motor;
  bool actuator = false;                             ///< a linear one: there is no crank
  int from_link = 0, to_link = 0;                    ///< carries the motor; is moved by the rod
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< on the crank's axis; foot of an actuator
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();   ///< of the crank, unit vector
  Eigen::Vector3d pin = Eigen::Vector3d::Zero();     ///< with the motor at 0; all in `from_link`
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();  ///< in `to_link`
  double length = 0.0;                               ///< of an actuator: with the motor at 0
  double branch = 1.0;                               ///< of the two positions of the crank
  std::vector<RodUncertainty> uncertain = {};        ///< each is a parameter
};

/// Joints that are moved by rods, one rod for each joint: two rods of an ankle, or one of a knee
/// whose motor is above (a four-bar). The motors are measured, not the joints. Positions of motors
/// and joints belong to each other one to one, so that everywhere else the robot is its tree, with
/// joints at the positions that the nominal rods give them.
///
/// The loops are closed on the nominal tree: |pin(motor) - anchor(joints)| = length for each rod.
/// Displaced axes between the two links act like displaced pins and anchors.
struct Linkage {
  std::string name;
  std::vector<int> joints;  ///< revolute ones that follow no others, between the rods' links
  std::vector<Rod> rods;    ///< as many
  /// Positions of the joints at which it is put together: which of several solutions is meant.
  Eigen::VectorXd assembled;

  int error_count() const;  ///< of all rods' uncertain quantities, in their order
};

/// Lengths that are 0 are set to what closes the loops with motors and joints at zero; the branch
/// of each crank to the one nearer to zero when the joints are at `assembled`. Adds the linkage to
/// the tree. Throws InputError where joints or links do not fit together, a rod cannot reach, or
/// the rods cannot move the joints.
void AddLinkage(Linkage linkage, RobotTree& tree);

/// Positions of the motors (rad; actuators m) with the linkage's joints at `positions`, by the
/// nominal rods: explicit. Nothing where a rod cannot reach.
std::optional<Eigen::VectorXd> MotorPositions(const RobotTree& tree, const Linkage& linkage,
                                              const Eigen::VectorXd& positions);

/// By how much each rod is too short for motors and joints at these positions, m.
Eigen::VectorXd LoopGaps(const RobotTree& tree, const Linkage& linkage,
                         const Eigen::VectorXd& motors, const Eigen::VectorXd& positions);

/// Positions of the linkage's joints for those of the motors, by rods with `errors` (see
/// Linkage::error_count; empty: none), from a start nearby.
struct Closure {
  Eigen::VectorXd positions;  ///< rad
  Eigen::MatrixXd by_errors;  ///< their derivatives by the errors: joints x error_count
  Eigen::MatrixXd by_motors;  ///< and by the motors: joints x motors
};

/// By Newton's method from `start`, and the implicit function theorem. Nothing where it does not
/// converge.
std::optional<Closure> CloseLinkage(const RobotTree& tree, const Linkage& linkage,
                                    const Eigen::VectorXd& motors, const Eigen::VectorXd& errors,
                                    const Eigen::VectorXd& start);

/// The same without errors and from `assembled`, in small steps: the solution that the mechanism
/// reaches by itself. Nothing where a rod would have to be longer or shorter on the way.
std::optional<Eigen::VectorXd> JointsFromMotors(const RobotTree& tree, const Linkage& linkage,
                                                const Eigen::VectorXd& motors);

/// The least lever with which motors, through the rods, move the linkage's joints at `positions`,
/// as a share of that where the linkage is put together: 0 at a dead point, and where a rod cannot
/// reach.
double LeverShare(const RobotTree& tree, const Linkage& linkage, const Eigen::VectorXd& positions);

/// Whether a joint belongs to a linkage.
bool IsMovedByRods(const RobotTree& tree, int joint);

/// Entries of q that the linkage's joints have, in their order.
std::vector<int> CoordinatesOf(const RobotTree& tree, const Linkage& linkage);

/// Whether all linkages of the tree close at q.
bool LinkagesClose(const RobotTree& tree, const Eigen::VectorXd& q);

/// The rods with errors: lengths, crank and anchors as they are.
Linkage WithErrors(const Linkage& linkage, const Eigen::VectorXd& errors);

}  // namespace elastocal
