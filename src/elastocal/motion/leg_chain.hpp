// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/standing.hpp"

namespace elastocal {

/// How many entries of q of its own a leg has at least whose foot can be placed.
constexpr std::size_t LeastLegJoints(bool on_ball) { return on_ball ? 3 : 5; }

/// A leg: the joints from the root link to a sole. It has five or more entries of q of its own, or
/// three or more if its sole is a ball, of which only the place counts; joints within it may be
/// coupled. A joint that moves another leg too (a waist above the legs, hips that share a motor)
/// stays where it is when the leg is placed. With more than six (three) entries of its own, the leg
/// stays near the posture from which it is placed, or goes by the one that is preferred; with five,
/// only some poses of the sole are in reach (those parallel to the root link, where what is missing
/// is the joint about the vertical).
class LegChain {
 public:
  /// Keeps a reference. `soles`: all of the robot, this one among them or not. Throws InputError
  /// for fewer joints of its own.
  LegChain(const RobotTree& tree, const Sole& sole, const std::vector<Sole>& soles = {});

  int sole_link() const { return sole_link_; }
  bool on_ball() const { return on_ball_; }
  /// Its own entries of q, from the root on.
  const std::vector<int>& coordinates() const { return coordinates_; }
  /// Whether the root link has to turn about the vertical for the foot to keep its pose, because
  /// too few joints are its own and others are shared with other legs.
  bool turns_root() const { return turns_root_; }
  /// The entries of q that it shares with other legs, from the root on.
  const std::vector<int>& shared_coordinates() const { return shared_; }

  /// Sum of the distances between the joints from the first one to the sole in the zero posture, m.
  double length() const { return length_; }

  /// Pose of the sole in the root link's frame.
  Transform SolePose(const Eigen::VectorXd& q) const;

  /// A leg with spare joints has many postures with the same pose of the sole. `Place` takes from
  /// now on the one that differs from `q` only by what moves the sole (as seen at `q`). It then
  /// depends on the pose alone, not on the way to it. Legs without spare joints are left as they
  /// are.
  void Prefer(const Eigen::VectorXd& q);

  /// Moves the leg's joints in `q` by Newton's method until the sole has the given pose in the root
  /// link's frame (1e-11 m and rad), or if it is a ball the place of that pose. Limits are not
  /// checked. Returns false, with the joints anywhere, if the pose is out of reach or the knee gets
  /// straight.
  bool Place(const Transform& T_root_sole, Eigen::VectorXd& q) const;

  /// The same, but the sole of a leg of five joints, which cannot have every pose, may turn about
  /// its normal.
  bool PlaceFlat(const Transform& T_root_sole, Eigen::VectorXd& q) const;

  /// The same as `Place` for a pose of the sole in the world. A root link that has to turn (see
  /// `turns_root`) is turned about the vertical through its origin.
  bool PlaceUnderRoot(const Transform& T_world_sole, Transform& T_world_root,
                      Eigen::VectorXd& q) const;

 private:
  /// What else may turn, beside the leg's joints, while the sole is placed.
  enum class Turns { kNothing, kSole, kRoot };
  /// `up`: the axis of a root link that turns, in its frame. Returns nothing if the sole is out of
  /// reach, and otherwise the angle by which the root link turns, rad.
  std::optional<double> Solve(Transform T_root_sole, Turns turns, const Eigen::Vector3d& up,
                              Eigen::VectorXd& q) const;
  /// Pose of the sole; sets `screws` to its derivatives, 6 x coordinates: a rotation and the
  /// velocity of the point at the root's origin.
  Transform Evaluate(const Eigen::VectorXd& q, Eigen::MatrixXd& screws) const;
  /// How many numbers `Place` sets: those of the sole's pose, or of a ball's place.
  int placed() const { return on_ball_ ? 3 : 6; }

  const RobotTree& tree_;
  int sole_link_;
  bool on_ball_, turns_root_ = false;
  double length_ = 0.0;
  std::vector<int> joints_, coordinates_, shared_;
  Eigen::VectorXd preferred_;  ///< by the leg's coordinates; empty: none
  Eigen::MatrixXd still_;      ///< rows: directions of the joints in which the sole stays, there
};

}  // namespace elastocal
