// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace elastocal {

struct RobotTree;

/// Quantity of a rod, or of the crank of its motor, that can be in error. Lengths in m, kZero in
/// rad.
enum class RodQuantity {
  kLength,  ///< distance between pin and anchor
  kZero,    ///< true position of the motor less the measured one
  kRadius,  ///< radius of the crank
  kAnchorX,
  kAnchorY,
  kAnchorZ,  ///< position of the anchor, in the axes of the link that is moved
  kCentreX,
  kCentreY,
  kCentreZ,  ///< position of the crank with its axis (foot of an actuator), in its link's axes
};

/// Name of a quantity as in parameter names: length, zero, radius, anchor_x ... centre_z.
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
  bool actuator = false;                             ///< linear actuator: there is no crank
  int from_link = 0, to_link = 0;                    ///< carries the motor; is moved by the rod
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< on the crank's axis; foot of an actuator
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();   ///< of the crank, unit vector
  Eigen::Vector3d pin = Eigen::Vector3d::Zero();     ///< with the motor at 0; all in `from_link`
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();  ///< in `to_link`
  double length = 0.0;                               ///< m; of an actuator: with the motor at 0
  double branch = 1.0;                               ///< 1 or -1: which position the crank takes
  std::vector<RodUncertainty> uncertain = {};        ///< each is a parameter
};

/// Joints that are moved by rods, one rod for each joint: two rods of an ankle, or one of a knee
/// whose motor is above (a four-bar). The motors are measured, not the joints. Each position of the
/// motors gives one position of the joints. Everywhere else the robot is therefore described by its
/// tree, with the joints at the positions that the nominal rods give them.
///
/// The loops are closed on the nominal tree: |pin(motor) - anchor(joints)| = length for each rod.
/// Displaced axes between the two links act like displaced pins and anchors.
struct Linkage {
  std::string name;
  std::vector<int> joints;  ///< revolute, no mimic joints, between the rods' links
  std::vector<Rod> rods;    ///< as many as joints
  /// Positions of the joints at which the linkage is put together, rad. They choose between several
  /// solutions of the loops.
  Eigen::VectorXd assembled;

  int error_count() const;  ///< number of uncertain quantities of all rods
};

/// Adds a linkage to the tree. A length of 0 is set to the one that closes the loop with motors and
/// joints at zero. Of the two positions of each crank, the branch is the one nearer to zero when
/// the joints are at `assembled`. Throws InputError if joints or links do not fit together, a rod
/// cannot reach, or the rods cannot move the joints.
void AddLinkage(Linkage linkage, RobotTree& tree);

/// Positions of the motors (rad; actuators m) with the linkage's joints at `positions`, by the
/// nominal rods, in closed form. Nothing if a rod cannot reach.
std::optional<Eigen::VectorXd> MotorPositions(const RobotTree& tree, const Linkage& linkage,
                                              const Eigen::VectorXd& positions);

/// For each rod, distance of pin and anchor less the rod's length, with motors and joints at these
/// positions, m: by how much the rod is too short.
Eigen::VectorXd LoopGaps(const RobotTree& tree, const Linkage& linkage,
                         const Eigen::VectorXd& motors, const Eigen::VectorXd& positions);

/// Positions of a linkage's joints that close its loops for given motors, and their derivatives.
struct Closure {
  Eigen::VectorXd positions;  ///< rad
  Eigen::MatrixXd by_errors;  ///< derivatives by the errors: joints x error_count
  Eigen::MatrixXd by_motors;  ///< derivatives by the motors: joints x motors
};

/// Closes the loops by Newton's method from the nearby positions `start`. The rods have `errors`
/// (Linkage::error_count of them; empty: none). Derivatives follow from the implicit function
/// theorem. Nothing if it does not converge.
std::optional<Closure> CloseLinkage(const RobotTree& tree, const Linkage& linkage,
                                    const Eigen::VectorXd& motors, const Eigen::VectorXd& errors,
                                    const Eigen::VectorXd& start);

/// Positions of the joints by the nominal rods, for motors that move in small steps from where they
/// are at `assembled`. This is the solution that the mechanism reaches by itself. Nothing if the
/// loops cannot be closed on the way, or if MotorPositions does not give the same motors.
std::optional<Eigen::VectorXd> JointsFromMotors(const RobotTree& tree, const Linkage& linkage,
                                                const Eigen::VectorXd& motors);

/// The least lever (LeastLever) with which the motors move the linkage's joints at `positions`, as
/// a share of that at `assembled`. 0 at a dead point, and if a rod cannot reach.
double LeverShare(const RobotTree& tree, const Linkage& linkage, const Eigen::VectorXd& positions);

/// Whether a joint belongs to a linkage.
bool IsMovedByRods(const RobotTree& tree, int joint);

/// Entries of q that drive the linkage's joints, in the order of the joints.
std::vector<int> CoordinatesOf(const RobotTree& tree, const Linkage& linkage);

/// Whether all linkages of the tree close at q.
bool LinkagesClose(const RobotTree& tree, const Eigen::VectorXd& q);

/// The linkage with `errors` (Linkage::error_count of them) added to its rods and cranks.
Linkage WithErrors(const Linkage& linkage, const Eigen::VectorXd& errors);

}  // namespace elastocal
