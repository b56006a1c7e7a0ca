// SPDX-License-Identifier: Apache-2.0
#include "elastocal/motion/move_builder.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/math/smooth_step.hpp"
#include "elastocal/motion/swinging_feet.hpp"
#include "elastocal/robot/inverse_dynamics.hpp"

namespace elastocal {
namespace {

/// Share of a way that is done, from 0 to 1, for rows that rest at both ends and move in between.
Eigen::VectorXd ShareOfWay(Eigen::Index samples, Eigen::Index before, Eigen::Index after) {
  Eigen::VectorXd progress(samples);
  const auto moving = static_cast<double>(samples - 1 - before - after);
  for (Eigen::Index i = 0; i < samples; ++i) {
    progress[i] = SmoothStep(static_cast<double>(i - before) / moving);
  }
  return progress;
}

/// About where the root link is while the joints are at `q` on the way from one posture to another:
/// it moves in time, and a detour takes longer on one side.
Transform RootOnTheWay(const PlacedPosture& from, const PlacedPosture& to,
                       const std::vector<int>& moving, const Eigen::VectorXd& q) {
  double along = 0.0, whole = 0.0;
  for (const int c : moving) {
    along += (q[c] - from.q[c]) * (to.q[c] - from.q[c]);
    whole += (to.q[c] - from.q[c]) * (to.q[c] - from.q[c]);
  }
  const double share = whole > 0.0 ? std::clamp(along / whole, 0.0, 1.0) : 0.0;
  return RootBetween(from.T_world_root, to.T_world_root, share);
}

constexpr double kEnds = 0.5;  // s, hold at either end, in which the root link starts and stops

}  // namespace

Transform TiltedSole(const Transform& T_world_sole, const Eigen::Vector2d& tilt) {
  Transform T = T_world_sole;
  T.linear() = T.linear() * RotationFromVector({tilt.x(), tilt.y(), 0.0});
  return T;
}

PlanOptions SizedOptions(const StandingRobot& robot, PlanOptions options) {
  constexpr double kInset = 0.54, kLift = 0.123;
  if (options.inset <= 0.0) options.inset = kInset * robot.half_support;
  if (options.lift_m <= 0.0) options.lift_m = kLift * robot.leg_length;
  return options;
}

Eigen::Index MoveBuilder::SamplesOf(double seconds) const {
  return static_cast<Eigen::Index>(std::lround(seconds * options_.rate_hz));
}

Eigen::Vector2d MoveBuilder::HandOver(const std::vector<int>& onto) const {
  const Eigen::Vector2d centre = SupportCentre(robot_, onto);
  if (onto.size() > 1) return centre;
  const Eigen::Vector2d inwards = SupportCentre(robot_, robot_.AllFeet()) - centre;
  return centre + options_.inset * inwards.normalized();
}

bool MoveBuilder::Balanced(const std::vector<int>& standing, PlacedPosture& pose) const {
  if (options_.balanced && !robot_.Held()) {
    return BalanceAtRest(robot_, standing, SupportCentre(robot_, standing), pose);
  }
  pose.T_world_root = robot_.T_world_root;
  return PlaceFeet(robot_, standing, pose);
}

std::optional<Refusal> MoveBuilder::KeepAtRest(const std::vector<int>& standing, double spare,
                                               PlacedPosture& pose) const {
  if (!Balanced(standing, pose)) return OutOfReach();
  if (!options_.balanced) return std::nullopt;
  const MotionMargins margins =
      CheckMotion(robot_, {options_.rate_hz, pose.q.transpose(), {standing}});
  if (margins.floor.value < LeastHeight(robot_)) {
    return Refusal{Constraint::kFloor, margins.floor.value, margins.floor.index};
  }
  MotionLimits limits = robot_.limits;
  limits.clearance += spare;
  return Refuse(margins, limits);
}

std::optional<PlacedPosture> MoveBuilder::AtRest(const Eigen::VectorXd& q,
                                                 const std::vector<int>& standing,
                                                 const PlacedPosture& near, Refusal& why) const {
  // Leaning or turning the waist moves the support leg away from a swinging one, and joints away
  // from their ends.
  constexpr std::array<double, 5> kTurns = {0.0, 0.12, -0.12, 0.24, -0.24};  // rad, about z
  // Additional distance, if possible, so that there is a way too, as a share of the leg's length.
  constexpr double kSpare = 0.0075;
  if (standing.size() == robot_.soles.size()) {
    return AtHeights(q, standing, near, {robot_.T_world_root.linear(), 0.0}, why);
  }
  for (const double spare : {kSpare * robot_.leg_length, 0.0}) {
    for (const double tilt : kRootTilts) {
      for (const double turn : kTurns) {
        Refusal refusal;
        const Transform attitude =
            RotZ(turn) * RotX(tilt) * Transform(robot_.T_world_root.linear());
        const auto found = AtHeights(q, standing, near, {attitude.linear(), spare}, refusal);
        if (found) return found;
        if (tilt == 0.0 && turn == 0.0) why = refusal;
        if (why.constraint != Constraint::kClearance && why.constraint != Constraint::kPosition &&
            why.constraint != Constraint::kFloor) {
          return std::nullopt;
        }
      }
    }
  }
  return std::nullopt;
}

std::optional<PlacedPosture> MoveBuilder::AsGiven(const Eigen::VectorXd& q,
                                                  const std::vector<int>& standing,
                                                  Refusal& why) const {
  PlacedPosture pose{q, robot_.T_world_root};
  if (!standing.empty()) pose.T_world_root = RootOverFeet(robot_, standing, q);
  if (!PlaceFeet(robot_, standing, pose)) {
    why = OutOfReach();
    return std::nullopt;
  }
  const MotionMargins margins =
      CheckMotion(robot_, {options_.rate_hz, pose.q.transpose(), {standing}});
  const auto refusal = Refuse(margins, robot_.limits);
  if (!refusal) return pose;
  why = *refusal;
  return std::nullopt;
}

std::optional<PlacedPosture> MoveBuilder::AtHeights(const Eigen::VectorXd& q,
                                                    const std::vector<int>& standing,
                                                    const PlacedPosture& near, const Manner& manner,
                                                    Refusal& why) const {
  constexpr int kSteps = 5, kHalvings = 3;
  constexpr double kAboveFloor = 0.037, kLower = 0.037;  // shares of the leg's length
  std::optional<double> too_low, too_high;
  PlacedPosture pose{q, near.T_world_root};
  pose.T_world_root.linear() = manner.attitude;
  double& height = pose.T_world_root.translation().z();
  height = robot_.T_world_root.translation().z();
  for (int i = 0; i < kSteps + kHalvings; ++i) {
    for (const int foot : standing) {
      for (const int c : robot_.legs[Size(foot)].coordinates()) pose.q[c] = near.q[c];
    }
    const auto refusal = KeepAtRest(standing, manner.spare, pose);
    if (!refusal) return pose;
    if (i == 0) why = *refusal;
    if (refusal->constraint == Constraint::kFloor) {
      too_low = height;
      height += kAboveFloor * robot_.leg_length - refusal->value;
    } else if (refusal->constraint == Constraint::kReach ||
               refusal->constraint == Constraint::kKnee) {
      too_high = height;
      height -= kLower * robot_.leg_length;
    } else {
      why = *refusal;
      break;
    }
    if (i + 1 < kSteps) continue;
    if (!too_low || !too_high) break;
    height = 0.5 * (*too_low + *too_high);
  }
  return std::nullopt;
}

std::optional<PlacedPosture> MoveBuilder::AtRestWithFoot(const std::vector<int>& standing, int foot,
                                                         const Transform& T_world_sole,
                                                         const PlacedPosture& near,
                                                         Refusal& why) const {
  // The foot is kept in place while the root link moves, which moves the centre of mass again:
  // hence rounds.
  constexpr int kRounds = 40;
  constexpr double kReached = 1e-12;
  PlacedPosture pose = near;
  for (int i = 0; i < kRounds; ++i) {
    const Eigen::Vector3d before = pose.T_world_root.translation();
    if (!PlaceSole(robot_, foot, T_world_sole, pose) || !Balanced(standing, pose)) break;
    if (i > 0 && (pose.T_world_root.translation() - before).norm() < kReached) {
      // Not AtRest: another attitude of the root link would take the foot elsewhere.
      const auto refusal = KeepAtRest(standing, 0.0, pose);
      if (!refusal) return pose;
      why = *refusal;
      return std::nullopt;
    }
  }
  why = OutOfReach();
  return std::nullopt;
}

Eigen::MatrixXd MoveBuilder::WithEnds(const Eigen::MatrixXd& way) const {
  const Eigen::Index ends = SamplesOf(kEnds);
  Eigen::MatrixXd held(way.rows() + 2 * ends, way.cols());
  held << way.row(0).replicate(ends, 1), way, way.row(way.rows() - 1).replicate(ends, 1);
  return held;
}

std::optional<Eigen::MatrixXd> MoveBuilder::BalanceAndCheck(const Stretch& stretch,
                                                            Refusal& why) const {
  BalanceOptions balance = options_.balance;
  if (!options_.balanced || robot_.Held()) balance.passes = 0;
  BalancedStretch balanced = Balance(robot_, stretch, balance);
  if (!balanced.in_reach) {
    why = OutOfReach();
    return std::nullopt;
  }
  if (!options_.balanced) return std::move(balanced.q);
  SampledMotion motion{options_.rate_hz, std::move(balanced.q), {}};
  motion.standing.assign(Size(motion.q.rows()), stretch.standing);
  if (const auto refusal = Refuse(CheckMotion(robot_, motion), robot_.limits)) {
    why = *refusal;
    return std::nullopt;
  }
  return std::move(motion.q);
}

std::optional<Eigen::MatrixXd> MoveBuilder::Follow(const PlacedPosture& from,
                                                   const PlacedPosture& to,
                                                   const std::vector<int>& standing,
                                                   const Eigen::MatrixXd& way, Refusal& why) const {
  Stretch stretch;
  stretch.rate_hz = options_.rate_hz;
  stretch.q = WithEnds(way);
  stretch.standing = standing;
  stretch.zmp = ZmpWay(from, to, standing, stretch.q.rows());
  stretch.begin = from;
  stretch.end = to;
  return BalanceAndCheck(stretch, why);
}

Eigen::MatrixX2d MoveBuilder::ZmpWay(const PlacedPosture& from, const PlacedPosture& to,
                                     const std::vector<int>& standing, Eigen::Index samples) const {
  constexpr double kBalanced = 1e-6;  // m
  const Eigen::Vector2d centre = SupportCentre(robot_, standing);
  const auto at_rest = [&](const PlacedPosture& pose) -> Eigen::Vector2d {
    const Eigen::Vector2d com =
        (pose.T_world_root * CentreOfMass(robot_.tree, robot_.inertias, pose.q)).head<2>();
    return (com - centre).norm() < kBalanced ? centre : com;
  };
  const Eigen::RowVector2d begin = at_rest(from).transpose();
  const Eigen::RowVector2d way = at_rest(to).transpose() - begin;
  return begin.replicate(samples, 1) +
         ShareOfWay(samples, SamplesOf(kEnds), SamplesOf(kEnds)) * way;
}

std::optional<Eigen::MatrixXd> MoveBuilder::Move(const PlacedPosture& from, const PlacedPosture& to,
                                                 const std::vector<int>& standing,
                                                 Refusal& why) const {
  constexpr double kSlower = 1.5;
  std::vector<int> moving;
  for (int c = 0; c < from.q.size(); ++c) {
    const bool stands = std::any_of(standing.begin(), standing.end(), [&](int foot) {
      const auto& leg = robot_.legs[Size(foot)].coordinates();
      return std::find(leg.begin(), leg.end(), c) != leg.end();
    });
    if (!stands && from.q[c] != to.q[c]) moving.push_back(c);
  }
  const bool turns_root = !standing.empty() && robot_.legs[Size(standing.front())].turns_root();
  const Clearances apart = [&](const Eigen::VectorXd& q) {
    PlacedPosture pose{q, RootOnTheWay(from, to, moving, q)};
    if (turns_root && !PlaceFeet(robot_, standing, pose)) pose.q = q;
    return DistancesAboveFloor(robot_, standing, options_.path.clearance, pose);
  };
  JointPath path = PlanJointPath(robot_, apart, from.q, to.q, moving, options_.path);
  for (int i = 0; i <= options_.slower; ++i, path.duration_s *= kSlower) {
    auto found = Follow(from, to, standing, SamplePath(path, options_.rate_hz), why);
    if (found) return found;
    const bool speed_matters =
        why.constraint == Constraint::kVelocity || why.constraint == Constraint::kTorque ||
        why.constraint == Constraint::kZmp || why.constraint == Constraint::kFriction;
    if (!speed_matters) break;
  }
  return std::nullopt;
}

Eigen::MatrixXd MoveBuilder::SineWay(const Eigen::VectorXd& q, int coordinate, double share) const {
  const SineOptions& sine = options_.sine;
  const Joint& joint = robot_.tree.joints[Size(robot_.tree.coordinate_joint[Size(coordinate)])];
  const auto [lower, upper] = PostureRange(joint, 0.0, robot_.rest[coordinate]);
  const double omega = 2.0 * M_PI * sine.frequency_hz;
  const double amplitude =
      std::min(0.5 * share * (upper - lower),
               0.8 * robot_.limits.velocity_share * joint.limits.velocity / omega);
  // As the sine shrinks, its middle moves to the posture, which is feasible.
  const double middle = 0.5 * (lower + upper);
  const double centre = q[coordinate] + share / sine.share * (middle - q[coordinate]);
  const double ramp = 1.0 / sine.frequency_hz;
  const double duration = (sine.periods + 2.0) * ramp;
  Eigen::MatrixXd way = q.transpose().replicate(SamplesOf(duration) + 1, 1);
  for (Eigen::Index i = 0; i < way.rows(); ++i) {
    const double time = static_cast<double>(i) / options_.rate_hz;
    const double in = SmoothStep(time / ramp);
    const double out = SmoothStep((duration - time) / ramp);
    way(i, coordinate) += in * out * (centre - q[coordinate] + amplitude * std::sin(omega * time));
  }
  return way;
}

std::optional<Eigen::MatrixXd> MoveBuilder::Sine(const PlacedPosture& at,
                                                 const std::vector<int>& standing, int coordinate,
                                                 double share, Refusal& why) const {
  const Eigen::MatrixXd way = SineWay(at.q, coordinate, share);
  for (const int foot : SwingingFeet(robot_, standing)) {
    const auto height = [&](const Eigen::VectorXd& q) {
      const std::vector<double> heights = HeightsOfFoot(robot_, foot, {q, at.T_world_root});
      return *std::min_element(heights.begin(), heights.end());
    };
    const double least = std::min(LeastHeight(robot_), height(at.q));
    for (Eigen::Index i = 0; i < way.rows(); ++i) {
      const double there = height(way.row(i).transpose());
      if (there >= least) continue;
      why = {Constraint::kFloor, there, foot};
      return std::nullopt;
    }
  }
  return Follow(at, at, standing, way, why);
}

std::optional<Eigen::MatrixXd> MoveBuilder::Shift(const PlacedPosture& from,
                                                  const PlacedPosture& to,
                                                  const std::vector<int>& onto,
                                                  Refusal& why) const {
  Stretch stretch;
  stretch.rate_hz = options_.rate_hz;
  stretch.standing = robot_.AllFeet();
  stretch.q = WithEnds(from.q.transpose().replicate(SamplesOf(options_.shift_s) + 1, 1));
  const Eigen::VectorXd progress = ShareOfWay(stretch.q.rows(), SamplesOf(kEnds), SamplesOf(kEnds));
  const Eigen::RowVector2d begin = SupportCentre(robot_, stretch.standing).transpose();
  const Eigen::RowVector2d way = HandOver(onto).transpose() - begin;
  stretch.zmp = begin.replicate(progress.size(), 1) + progress * way;
  stretch.begin = from;
  stretch.end = to;
  return BalanceAndCheck(stretch, why);
}

std::optional<Eigen::MatrixXd> MoveBuilder::Lift(const PlacedPosture& from, const PlacedPosture& to,
                                                 const std::vector<int>& standing, int foot,
                                                 const Eigen::Vector2d& tilt, Refusal& why) const {
  Stretch stretch;
  stretch.rate_hz = options_.rate_hz;
  stretch.standing = standing;
  stretch.q = WithEnds(from.q.transpose().replicate(SamplesOf(options_.lift_s) + 1, 1));
  // First the foot rises a little, then the rest of the weight is shifted, then the foot rises
  // further. If the robot tips towards the foot, that foot is still near the floor.
  const Eigen::Index ends = SamplesOf(kEnds);
  const auto part = [&](double first, double last) {
    return ShareOfWay(stretch.q.rows(), ends + SamplesOf(first * options_.lift_s),
                      ends + SamplesOf((1.0 - last) * options_.lift_s));
  };
  constexpr double kFirst = 0.1;
  const Eigen::VectorXd second = part(0.6, 1.0);
  const Eigen::VectorXd lifted =
      options_.lift_m * (kFirst * part(0.0, 0.4) + (1.0 - kFirst) * second);
  const Eigen::VectorXd shifted = part(0.25, 0.75);
  stretch.led = foot;
  for (Eigen::Index i = 0; i < lifted.size(); ++i) {
    stretch.T_world_led.push_back(Eigen::Translation3d(0.0, 0.0, lifted[i]) *
                                  TiltedSole(robot_.T_world_sole[Size(foot)], tilt * second[i]));
  }
  const Eigen::RowVector2d begin = HandOver(standing).transpose();
  const Eigen::RowVector2d way = SupportCentre(robot_, standing).transpose() - begin;
  stretch.zmp = begin.replicate(shifted.size(), 1) + shifted * way;
  stretch.begin = from;
  stretch.end = to;
  return BalanceAndCheck(stretch, why);
}

}  // namespace elastocal
