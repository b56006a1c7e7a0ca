// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/math/random.hpp"
#include "elastocal/robot/inverse_dynamics.hpp"
#include "elastocal/robot/legs.hpp"

namespace elastocal {

/// A box and a cone for the end of a chain (paper section 3.1 and Fig. 2), in the root link's
/// frame: x ahead, y outwards (to the side of the chain), z up.
struct EndWorkspace {
  Eigen::Vector3d lower, upper;  ///< m
  double largest_turn;           ///< largest angle to the attitude in the zero posture, rad
};

/// Limits of random postures. Lengths are those of a robot whose root link stands 1.083 m high
/// (TALOS); for other robots they are scaled by that height.
struct PostureOptions {
  EndWorkspace foot{{-0.35, -0.05, -1.08}, {0.35, 0.35, -0.65}, 1.0472};
  EndWorkspace hand{{0.15, -0.10, -0.10}, {0.65, 0.55, 0.60}, M_PI};
  int arm_joints = 5;  ///< chains with at least this many joints are arms, which keep to `hand`
  double limit_margin = 0.05;      ///< share of a joint's range that is left free at either end
  double least_distance = 0.13;    ///< between joint centres of the moving chain and of others, m
  double ground_clearance = 0.03;  ///< least height of the swinging sole's origin, m
  /// The support leg: its knee (the joint that bends most in standing) is bent within these limits,
  /// rad. The waist is lower than over straight legs by these shares of the standing height, and
  /// leans and turns. The robot's centre of mass is above a point of the sole up to `sway` from its
  /// origin.
  double least_bend = 0.4, largest_bend = 1.0;
  double least_drop = 0.01, largest_drop = 0.11;
  double largest_lean = 0.07, largest_turn = 0.10;  ///< rad
  Eigen::Vector2d sway{0.07, 0.045};                ///< m
};

/// The zero posture, moved inside the limits by the margin. By coordinate, like everything below.
Eigen::VectorXd HomePosture(const RobotTree& tree, const PostureOptions& options);

/// Moves the joints of a leg by Newton's method from `q`, within the limits, until its foot has the
/// given pose in the root link's frame. Returns nothing if the foot stays further away than
/// `tolerance` (norm of metres and radians). A leg with fewer than six joints of its own only comes
/// near the pose.
std::optional<Eigen::VectorXd> PlaceFoot(const RobotTree& tree, const Leg& leg,
                                         const Transform& T_waist_foot, Eigen::VectorXd q,
                                         double tolerance = 1e-8);

/// Draws feasible postures of a robot by its description.
class PostureSampler {
 public:
  /// Keeps references: tree and legs must outlive it.
  PostureSampler(const RobotTree& tree, const std::vector<Leg>& legs, const PostureOptions& options,
                 std::uint64_t seed);

  /// The robot stands on all feet with slightly bent knees; without legs, it is in the home
  /// posture.
  const Eigen::VectorXd& stand() const { return stand_; }
  /// Whether the robot can stand: it has one or two legs, all feet reach the floor in stand(), and
  /// with two legs, it can stand on each of them alone. True without legs.
  bool stands() const { return stands_; }

  /// The posture stand() with the joints of `chain` drawn at random in their ranges. The end of an
  /// arm is in the workspace of hands, unless hardly any posture has it there (a robot of another
  /// shape); then only the joint limits count.
  Eigen::VectorXd DrawUpper(const NamedChain& chain);

  /// A posture in which the foot of the leg `swing` is in its workspace, while the robot stands on
  /// the bent leg `support` with its foot flat on the floor; all other joints are as in `q`. Throws
  /// InputError if no such posture is found.
  Eigen::VectorXd DrawSwing(const Eigen::VectorXd& q, const Leg& swing, const Leg& support);

  /// Draws only the support leg; the other joints are those of `q`. Returns nothing if this draw is
  /// not feasible.
  std::optional<Eigen::VectorXd> DrawSupport(Eigen::VectorXd q, const Leg& swing,
                                             const Leg& support);

  /// Whether the swinging leg is in its workspace, above the floor and apart from the other.
  bool SwingFeasible(const Eigen::VectorXd& q, const Leg& swing, const Leg& support) const;

 private:
  void DrawJoints(const std::vector<int>& joints, Eigen::VectorXd& q);
  bool InWorkspace(const EndWorkspace& workspace, int tip, const Eigen::VectorXd& q) const;
  bool ArmApart(const NamedChain& chain, const Eigen::VectorXd& q) const;
  bool KneeBent(const Leg& leg, const Eigen::VectorXd& q) const;
  std::optional<Eigen::VectorXd> Bend(const Leg& leg, Eigen::VectorXd q, double drop);
  /// Whether postures are found on either leg alone; draws nothing that is drawn later.
  bool StandsOnEither();
  /// DrawSwing that gives up after some draws.
  std::optional<Eigen::VectorXd> TryDrawSwing(Eigen::VectorXd q, const Leg& swing,
                                              const Leg& support, int tries);

  const RobotTree& tree_;
  const std::vector<Leg>& legs_;
  PostureOptions options_;
  Random random_;
  std::vector<BodyInertia> inertias_;
  std::vector<Transform> T_root_link_zero_;
  double height_, scale_;
  Eigen::VectorXd stand_;
  bool stands_ = true;
};

}  // namespace elastocal
