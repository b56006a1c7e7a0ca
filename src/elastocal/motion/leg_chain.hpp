// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/standing.hpp"

namespace elastocal {

/// Least number of entries of q of its own that a leg needs for its foot to be placed.
constexpr std::size_t LeastLegJoints(bool on_ball) { return on_ball ? 3 : 5; }

/// A leg: the joints from the root link to a sole. It has at least five entries of q of its own, or
/// three if its sole is a ball, of which only the place counts. Joints within the leg may be
/// coupled. A joint that also moves another leg (a waist above the legs, hips that share a motor)
/// stays where it is when the leg is placed. A leg with more than six (three) entries of its own
/// stays near the posture from which it is placed, or follows the preferred posture (Prefer). A leg
/// with five can reach only some poses of the sole; if the joint about the vertical is missing,
/// these are the poses with the heading of the root link.
class LegChain {
 public:
  /// Keeps a reference to the tree. `soles` are those of the whole robot, with or without this one.
  /// Throws InputError if the leg has too few entries of q of its own (LeastLegJoints).
  LegChain(const RobotTree& tree, const Sole& sole, const std::vector<Sole>& soles = {});

  int sole_link() const { return sole_link_; }
  bool on_ball() const { return on_ball_; }
  /// Entries of q that move only this leg, from the root outwards.
  const std::vector<int>& coordinates() const { return coordinates_; }
  /// Whether the root link must turn about the vertical for the foot to keep its pose, because the
  /// leg has too few joints of its own and shares others with other legs.
  bool turns_root() const { return turns_root_; }
  /// The entries of q that it shares with other legs, from the root on.
  const std::vector<int>& shared_coordinates() const { return shared_; }

  /// Sum of the distances between the joints from the first one to the sole in the zero posture, m.
  double length() const { return length_; }

  /// Pose of the sole in the root link's frame.
  Transform SolePose(const Eigen::VectorXd& q) const;

  /// Sets the preferred posture of a leg with spare joints, for which many postures give the same
  /// pose of the sole. From now on, `Place` returns the posture that differs from `q` only in
  /// directions that move the sole (at `q`). The posture then depends on the pose alone, and not on
  /// the posture from which the leg is placed. Has no effect on legs without spare joints.
  void Prefer(const Eigen::VectorXd& q);

  /// Moves the leg's joints in `q` by Newton's method until the sole has the given pose in the root
  /// link's frame (1e-11 m and rad), or if it is a ball the place of that pose. Limits are not
  /// checked. Returns false, with the joints anywhere, if the pose is out of reach or the knee gets
  /// straight.
  bool Place(const Transform& T_root_sole, Eigen::VectorXd& q) const;

  /// Like `Place`, but the sole may turn about its normal, because a leg of five joints cannot
  /// reach every pose.
  bool PlaceFlat(const Transform& T_root_sole, Eigen::VectorXd& q) const;

  /// The same as `Place` for a pose of the sole in the world. A root link that has to turn (see
  /// `turns_root`) is turned about the vertical through its origin.
  bool PlaceUnderRoot(const Transform& T_world_sole, Transform& T_world_root,
                      Eigen::VectorXd& q) const;

 private:
  /// What may turn, besides the leg's joints, while the sole is placed.
  enum class Turns { kNothing, kSole, kRoot };
  /// `up`: the axis of a root link that turns, in its frame. Returns nothing if the sole is out of
  /// reach, and otherwise the angle by which the root link turns, rad.
  std::optional<double> Solve(Transform T_root_sole, Turns turns, const Eigen::Vector3d& up,
                              Eigen::VectorXd& q) const;
  /// Pose of the sole; sets `screws` to its derivatives, 6 x coordinates: a rotation and the
  /// velocity of the point at the root's origin.
  Transform Evaluate(const Eigen::VectorXd& q, Eigen::MatrixXd& screws) const;
  /// Number of coordinates that `Place` sets: six of a pose, or three of a ball's place.
  int placed() const { return on_ball_ ? 3 : 6; }

  const RobotTree& tree_;
  int sole_link_;
  bool on_ball_, turns_root_ = false;
  double length_ = 0.0;
  std::vector<int> joints_, coordinates_, shared_;
  Eigen::VectorXd preferred_;  ///< by the leg's coordinates; empty: none
  Eigen::MatrixXd still_;  ///< rows: directions of joints that do not move the sole at `preferred_`
};

}  // namespace elastocal
