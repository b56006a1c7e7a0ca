// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "elastocal/motion/plan.hpp"
#include "elastocal/motion/refusal.hpp"

namespace elastocal {

/// Inclinations of the root link about the x axis of the world that are tried, rad.
constexpr std::array<double, 5> kRootTilts = {0.0, 0.06, -0.06, 0.12, -0.12};

/// A sole turned by a rotation vector [rad] about its own x and y axes.
Transform TiltedSole(const Transform& T_world_sole, const Eigen::Vector2d& tilt);

/// The options with the lengths that follow from the robot's size.
PlanOptions SizedOptions(const StandingRobot& robot, PlanOptions options);

/// Makes motions from rest to rest on given feet, and checks each of them. All motions hold for a
/// moment at both ends, which is part of the hold of the posture; the root link starts and stops
/// moving in it.
class MoveBuilder {
 public:
  /// Keeps references. `options` are those of SizedOptions.
  MoveBuilder(const StandingRobot& robot, const PlanOptions& options)
      : robot_(robot), options_(options) {}

  /// Zero-moment point, m, at which the foot that is not in `onto` leaves the floor. If `onto` is
  /// one foot, the point is displaced from its middle towards the other foot; if there are several,
  /// it is in their middle.
  Eigen::Vector2d HandOver(const std::vector<int>& onto) const;

  /// The posture, balanced at rest on the feet. The joints of standing legs are solved for,
  /// starting from those of `near`. The root link is as high as in the posture of rest, higher if a
  /// swinging foot would touch the floor, lower if a leg does not reach; on one foot it leans or
  /// turns if the legs would touch. Nothing if the posture cannot be held; `why` then has the
  /// reason.
  std::optional<PlacedPosture> AtRest(const Eigen::VectorXd& q, const std::vector<int>& standing,
                                      const PlacedPosture& near, Refusal& why) const;

  /// The posture as it is given, including the legs. The feet give the pose of the root link
  /// (RootOverFeet), and the centre of mass the zero-moment point. All feet are then put exactly
  /// where they stand.
  std::optional<PlacedPosture> AsGiven(const Eigen::VectorXd& q, const std::vector<int>& standing,
                                       Refusal& why) const;

  /// As AtRest, with one foot held by its leg at a pose in the world.
  std::optional<PlacedPosture> AtRestWithFoot(const std::vector<int>& standing, int foot,
                                              const Transform& T_world_sole,
                                              const PlacedPosture& near, Refusal& why) const;

  /// Motion from one posture to another on a way of the joints.
  std::optional<Eigen::MatrixXd> Move(const PlacedPosture& from, const PlacedPosture& to,
                                      const std::vector<int>& standing, Refusal& why) const;

  /// Motion on the given way of the joints (samples x coordinates, from rest to rest), balanced.
  std::optional<Eigen::MatrixXd> Follow(const PlacedPosture& from, const PlacedPosture& to,
                                        const std::vector<int>& standing,
                                        const Eigen::MatrixXd& way, Refusal& why) const;

  /// Motion in which one coordinate swings in a sine about the middle of its range, from a posture
  /// and back to it. Its amplitude is at most the given share of the range and keeps the velocity
  /// limit. Swinging feet stay as high above the floor as in postures.
  std::optional<Eigen::MatrixXd> Sine(const PlacedPosture& at, const std::vector<int>& standing,
                                      int coordinate, double share, Refusal& why) const;

  /// Motion that shifts the weight from all feet to some of them.
  std::optional<Eigen::MatrixXd> Shift(const PlacedPosture& from, const PlacedPosture& to,
                                       const std::vector<int>& onto, Refusal& why) const;

  /// Motion that lifts a foot straight up by options.lift_m while the others stand, and tilts it
  /// (TiltedSole) on the second half of the way.
  std::optional<Eigen::MatrixXd> Lift(const PlacedPosture& from, const PlacedPosture& to,
                                      const std::vector<int>& standing, int foot,
                                      const Eigen::Vector2d& tilt, Refusal& why) const;

  Eigen::Index SamplesOf(double seconds) const;

 private:
  Eigen::MatrixXd SineWay(const Eigen::VectorXd& q, int coordinate, double share) const;
  /// Samples of the zero-moment point that lead from its place at rest in one posture to that in
  /// the other.
  Eigen::MatrixX2d ZmpWay(const PlacedPosture& from, const PlacedPosture& to,
                          const std::vector<int>& standing, Eigen::Index samples) const;
  std::optional<Eigen::MatrixXd> BalanceAndCheck(const Stretch& stretch, Refusal& why) const;
  /// The way with its first and last row held for a moment.
  Eigen::MatrixXd WithEnds(const Eigen::MatrixXd& way) const;
  /// Attitude of the root link, and the distance that parts keep in addition to the limit, m.
  struct Manner {
    Eigen::Matrix3d attitude;
    double spare;
  };
  std::optional<PlacedPosture> AtHeights(const Eigen::VectorXd& q, const std::vector<int>& standing,
                                         const PlacedPosture& near, const Manner& manner,
                                         Refusal& why) const;
  std::optional<Refusal> KeepAtRest(const std::vector<int>& standing, double spare,
                                    PlacedPosture& pose) const;
  bool Balanced(const std::vector<int>& standing, PlacedPosture& pose) const;

  const StandingRobot& robot_;
  const PlanOptions& options_;
};

}  // namespace elastocal
