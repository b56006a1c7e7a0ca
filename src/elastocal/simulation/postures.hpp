#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/math/random.hpp"
#include "elastocal/robot/inverse_dynamics.hpp"
#include "elastocal/robot/legs.hpp"

namespace elastocal {

/// A box and a cone in which the end of a chain is kept (paper section 3.1 and Fig. 2), in the root
/// link's frame: x ahead, y outwards (to the side on which the chain is), z up.
struct EndWorkspace {
  Eigen::Vector3d lower, upper;  ///< m
  double largest_turn;           ///< from the attitude in the zero posture, rad
};

/// What random postures keep to. Lengths are those of a robot whose root link stands 1.083 m high
/// (TALOS); they are scaled to others by that height.
struct PostureOptions {
  EndWorkspace foot{{-0.35, -0.05, -1.08}, {0.35, 0.35, -0.65}, 1.0472};
  EndWorkspace hand{{0.15, -0.10, -0.10}, {0.65, 0.55, 0.60}, M_PI};
  int arm_joints = 5;              ///< chains with as many are arms, kept to `hand`
  double limit_margin = 0.05;      ///< left free at either end of a joint's range, as a share of it
  double least_distance = 0.13;    ///< between joint centres of the moving and of other chains, m
  double ground_clearance = 0.03;  ///< of the swinging sole's origin, m
  /// The leg that carries: its knee (the joint that bends most in standing) is bent within these
  /// limits, rad; the waist is lower than over straight legs by these shares of the standing
  /// height, leans and turns, and the robot's centre of mass is above a point of the sole up to
  /// `sway` from its origin.
  double least_bend = 0.4, largest_bend = 1.0;
  double least_drop = 0.01, largest_drop = 0.11;
  double largest_lean = 0.07, largest_turn = 0.10;  ///< rad
  Eigen::Vector2d sway{0.07, 0.045};                ///< m
};

/// The zero posture, moved inside the limits by the margin. By coordinate, as all below.
Eigen::VectorXd HomePosture(const RobotTree& tree, const PostureOptions& options);

/// Moves the joints of a leg until its foot has the given pose in the root link's frame, by
/// Newton's method from `q`, within the limits. Nothing where the foot stays further away than
/// `tolerance` (metres and radians, norm): a leg with less than six joints of its own comes only
/// near.
std::optional<Eigen::VectorXd> PlaceFoot(const RobotTree& tree, const Leg& leg,
                                         const Transform& T_waist_foot, Eigen::VectorXd q,
                                         double tolerance = 1e-8);

/// Draws feasible postures of a robot, from its description.
class PostureSampler {
 public:
  /// Keeps references: tree and legs must outlive it.
  PostureSampler(const RobotTree& tree, const std::vector<Leg>& legs, const PostureOptions& options,
                 std::uint64_t seed);

  /// Standing on both feet (all legs; none: the home posture) with slightly bent knees.
  const Eigen::VectorXd& stand() const { return stand_; }

  /// Standing as in stand(), with the joints of `chain` drawn at random in their ranges and, of an
  /// arm, its end in the workspace of hands. Where hardly any posture has it there (a robot of
  /// other shape), the joint limits alone.
  Eigen::VectorXd DrawUpper(const NamedChain& chain);

  /// The leg `swing` in the workspace of feet, while the leg `support` carries, bent, with its foot
  /// flat on the floor; all other joints as in `q`. Throws InputError where no such posture is
  /// found.
  Eigen::VectorXd DrawSwing(Eigen::VectorXd q, const Leg& swing, const Leg& support);

  /// Only the leg that carries is drawn; the other joints are those of `q`. Nothing where this draw
  /// is not feasible.
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

  const RobotTree& tree_;
  const std::vector<Leg>& legs_;
  PostureOptions options_;
  Random random_;
  std::vector<BodyInertia> inertias_;
  std::vector<Transform> T_root_link_zero_;
  double height_, scale_;
  Eigen::VectorXd stand_;
};

}  // namespace elastocal
