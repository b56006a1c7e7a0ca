#pragma once

#include <optional>
#include <vector>

#include "elastocal/motion/plan.hpp"
#include "elastocal/motion/refusal.hpp"

namespace elastocal {

/// Makes motions from rest to rest on given feet, and checks each. All of them hold still for
/// a moment at both ends, in which the root link begins and ends to move: a part of the hold.
class MoveBuilder {
 public:
  /// Keeps references.
  MoveBuilder(const StandingRobot& robot, const PlanOptions& options)
      : robot_(robot), options_(options) {}

  /// Where the zero-moment point is when the foot that is not `onto` leaves the floor, m.
  Eigen::Vector2d HandOver(int onto) const;

  /// The posture, balanced at rest on the feet. Joints of standing legs are found, from those of
  /// `near`; the root link is as high as in the posture of rest, or higher where a swinging foot
  /// would touch the floor, or lower where a leg does not reach; on one foot it leans or turns
  /// where the legs would touch. Nothing where it cannot be kept, and then why.
  std::optional<PlacedPosture> AtRest(const Eigen::VectorXd& q, const std::vector<int>& standing,
                                      const PlacedPosture& near, Refusal& why) const;

  /// With a foot held at a pose in the world by its leg.
  std::optional<PlacedPosture> AtRestWithFoot(const std::vector<int>& standing, int foot,
                                              const Transform& T_world_sole,
                                              const PlacedPosture& near, Refusal& why) const;

  /// From pose to pose by a way of the joints.
  std::optional<Eigen::MatrixXd> Move(const PlacedPosture& from, const PlacedPosture& to,
                                      const std::vector<int>& standing, Refusal& why) const;

  /// The given way of the joints (samples x coordinates, from rest to rest), balanced.
  std::optional<Eigen::MatrixXd> Follow(const PlacedPosture& from, const PlacedPosture& to,
                                        const std::vector<int>& standing,
                                        const Eigen::MatrixXd& way, Refusal& why) const;

  /// A sine of one coordinate around the middle of its range, from `q` and back to it; at most the
  /// given share of the range, and of the velocity limit's share.
  Eigen::MatrixXd SineWay(const Eigen::VectorXd& q, int coordinate, double share) const;

  /// Weight from all feet over one of them.
  std::optional<Eigen::MatrixXd> Shift(const PlacedPosture& from, const PlacedPosture& to, int onto,
                                       Refusal& why) const;

  /// A foot straight up by options.lift_m while the others stand.
  std::optional<Eigen::MatrixXd> Lift(const PlacedPosture& from, const PlacedPosture& to,
                                      const std::vector<int>& standing, int foot,
                                      Refusal& why) const;

  Eigen::Index SamplesOf(double seconds) const;

 private:
  std::optional<Eigen::MatrixXd> BalanceAndCheck(const Stretch& stretch, Refusal& why) const;
  /// Holds the first and the last row for a moment more.
  Eigen::MatrixXd WithEnds(const Eigen::MatrixXd& way) const;
  /// Attitude of the root link, and what parts shall keep beyond the limit, m.
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
