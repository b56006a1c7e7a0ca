// SPDX-License-Identifier: Apache-2.0
#include "elastocal/motion/motion_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <utility>

#include "elastocal/math/numbers.hpp"
#include "elastocal/motion/sampled_motion.hpp"

namespace elastocal {
namespace {

void Least(Worst& worst, double value, Eigen::Index sample, int index) {
  if (worst.sample >= 0 && !(value < worst.value)) return;
  worst = {value, static_cast<int>(sample), index};
}

void Largest(Worst& worst, double value, Eigen::Index sample, int index) {
  if (worst.sample >= 0 && !(value > worst.value)) return;
  worst = {value, static_cast<int>(sample), index};
}

/// By how much the margin of a joint with a small range (a finger) is smaller than that of others,
/// rad or m.
double LessMargin(const JointLimits& limits, double margin) {
  constexpr double kShare = 0.02;
  return std::max(0.0, margin - kShare * (limits.upper - limits.lower));
}

void CheckJoints(const StandingRobot& robot, const RobotState& state, Eigen::Index sample,
                 MotionMargins& margins) {
  const RobotTree& tree = robot.tree;
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    const Joint& joint = tree.joints[k];
    const double position = JointPosition(joint, state.q);
    const double speed = JointRate(joint, state.velocity);
    const double acceleration = JointRate(joint, state.acceleration);
    const int index = static_cast<int>(k);
    const double less = LessMargin(joint.limits, robot.limits.position_margin);
    Least(margins.position,
          std::min(position - joint.limits.lower, joint.limits.upper - position) + less, sample,
          index);
    Largest(margins.velocity, std::abs(speed) / joint.limits.velocity, sample, index);
    Largest(margins.acceleration, std::abs(acceleration), sample, index);
  }
}

void CheckLevers(const RobotTree& tree, const Eigen::VectorXd& q, Eigen::Index sample,
                 MotionMargins& margins) {
  for (std::size_t i = 0; i < tree.linkages.size(); ++i) {
    const Linkage& linkage = tree.linkages[i];
    Least(margins.lever, LeverShare(tree, linkage, q(CoordinatesOf(tree, linkage))), sample,
          static_cast<int>(i));
  }
}

void CheckTorques(const RobotTree& tree, const Eigen::VectorXd& torques, Eigen::Index sample,
                  MotionMargins& margins) {
  for (Eigen::Index i = 0; i < torques.size(); ++i) {
    const int k = tree.coordinate_joint[Size(i)];
    const double limit = tree.joints[Size(k)].limits.effort;
    Largest(margins.torque, std::abs(torques[i]) / limit, sample, k);
  }
}

void CheckFeet(const StandingRobot& robot, const std::vector<int>& standing,
               const std::vector<Transform>& T_world_link, Eigen::Index sample,
               MotionMargins& margins) {
  for (const int foot : robot.AllFeet()) {
    const Sole& sole = robot.soles[Size(foot)];
    const Transform& found = T_world_link[Size(sole.link)];
    if (std::find(standing.begin(), standing.end(), foot) != standing.end()) {
      const Transform off = robot.T_world_sole[Size(foot)].inverse() * found;
      Largest(margins.foot_moved, off.translation().norm(), sample, foot);
      if (!sole.ball_radius) {
        Largest(margins.foot_turned, RotationAngle(off.linear()), sample, foot);
      }
      continue;
    }
    for (const double height : HeightsOverFloor(sole, found)) {
      Least(margins.floor, height, sample, foot);
    }
  }
}

void CheckKnees(const StandingRobot& robot, const std::vector<int>& standing,
                const Eigen::VectorXd& q, Eigen::Index sample, MotionMargins& margins) {
  for (const int foot : standing) {
    Least(margins.knee, std::abs(q[robot.knees[Size(foot)]]), sample, foot);
  }
}

}  // namespace

const char* ConstraintName(Constraint constraint) {
  constexpr std::array kNames = {"reach of the legs",
                                 "joint position limit",
                                 "joint velocity limit",
                                 "joint torque limit",
                                 "clearance of the robot's own parts",
                                 "zero-moment point inside the support polygon",
                                 "friction of the feet",
                                 "bent knee of a standing leg",
                                 "feet that stand still",
                                 "swinging foot above the floor",
                                 "lever of rods on their joints",
                                 "reach of the hand above the table"};
  return kNames[static_cast<std::size_t>(constraint)];
}

MotionMargins CheckMotion(const StandingRobot& robot, const SampledMotion& motion,
                          MotionForces* forces) {
  const Eigen::Index samples = motion.q.rows();
  const double step = 1.0 / motion.rate_hz;
  MotionMargins margins;
  margins.clearance.value = margins.floor.value = std::numeric_limits<double>::infinity();
  margins.lever.value = margins.floor.value;
  if (robot.Held()) margins.zmp.value = margins.knee.value = margins.floor.value;
  std::vector<Transform> T_world_root(Size(samples));
  std::vector<std::vector<Transform>> T_root_link(Size(samples));
  for (Eigen::Index i = 0; i < samples; ++i) {
    T_root_link[Size(i)] = LinkTransforms(robot.tree, motion.q.row(i).transpose());
    if (robot.Held()) {
      T_world_root[Size(i)] = robot.T_world_root;
      continue;
    }
    T_world_root[Size(i)] =
        RootOverFeet(robot, motion.standing[Size(i)], motion.q.row(i).transpose());
  }
  MotionForces found;
  found.zmp.resize(samples, 2);
  found.torques.resize(samples, motion.q.cols());
  for (Eigen::Index i = 0; i < samples; ++i) {
    const std::vector<int>& standing = motion.standing[Size(i)];
    const RobotState state = StateAt(motion.q, T_world_root, step, i);
    const auto floor = InverseDynamics(robot.tree, robot.inertias, state, kGravity);
    const Eigen::Vector2d zmp = ZeroMomentPoint(floor.force, floor.moment);
    std::vector<Sole> soles;
    std::vector<Transform> T_world_sole;
    for (const int foot : standing) {
      soles.push_back(robot.soles[Size(foot)]);
      T_world_sole.push_back(robot.T_world_sole[Size(foot)]);
    }
    const auto wrenches = robot.Held()
                              ? std::vector<LinkWrench>()
                              : ShareWrench(soles, T_world_sole, floor.force, floor.moment);
    const auto held = InverseDynamics(robot.tree, robot.inertias, state, kGravity, wrenches);
    std::vector<Transform>& T_world_link = T_root_link[Size(i)];
    for (Transform& T : T_world_link) T = T_world_root[Size(i)] * T;

    CheckJoints(robot, state, i, margins);
    CheckLevers(robot.tree, state.q, i, margins);
    CheckTorques(robot.tree, held.torques, i, margins);
    CheckFeet(robot, standing, T_world_link, i, margins);
    CheckKnees(robot, standing, state.q, i, margins);
    if (!robot.Held()) {
      Least(margins.zmp, InsideMargin(SupportPolygon(soles, T_world_sole), zmp), i, -1);
      Largest(margins.friction, floor.force.head<2>().norm() / floor.force.z(), i, -1);
    }
    if (robot.clearances) {
      const Eigen::VectorXd distances = robot.clearances(state.q);
      Eigen::Index pair = 0;
      if (distances.size() > 0) {
        const double least = distances.minCoeff(&pair);
        Least(margins.clearance, least, i, static_cast<int>(pair));
      }
    }
    found.zmp.row(i) = zmp.transpose();
    found.torques.row(i) = held.torques.transpose();
  }
  if (forces != nullptr) {
    *forces = std::move(found);
    forces->T_world_root = std::move(T_world_root);
  }
  return margins;
}

std::vector<Constraint> BrokenConstraints(const MotionMargins& margins,
                                          const MotionLimits& limits) {
  // The comparisons are written so that NaN breaks a limit.
  const auto below = [](const Worst& worst, double limit) { return !(worst.value >= limit); };
  const auto above = [](const Worst& worst, double limit) { return !(worst.value <= limit); };
  // Postures that are designed at the margin come from files with twelve digits.
  constexpr double kRounding = 1e-9;
  const std::initializer_list<std::pair<Constraint, bool>> checks = {
      {Constraint::kPosition, below(margins.position, limits.position_margin - kRounding)},
      {Constraint::kVelocity, above(margins.velocity, limits.velocity_share)},
      {Constraint::kTorque, above(margins.torque, limits.torque_share)},
      {Constraint::kClearance, below(margins.clearance, limits.clearance)},
      {Constraint::kZmp, below(margins.zmp, limits.zmp_margin)},
      {Constraint::kFriction, above(margins.friction, limits.friction)},
      {Constraint::kKnee, below(margins.knee, limits.least_knee)},
      {Constraint::kFeet,
       above(margins.foot_moved, kFootTolerance) || above(margins.foot_turned, kFootTolerance)},
      {Constraint::kFloor, below(margins.floor, -kFootTolerance)},
      {Constraint::kLever, below(margins.lever, limits.lever_share)}};
  std::vector<Constraint> broken;
  for (const auto& [constraint, breaks] : checks) {
    if (breaks) broken.push_back(constraint);
  }
  return broken;
}

std::optional<Constraint> Broken(const MotionMargins& margins, const MotionLimits& limits) {
  const std::vector<Constraint> broken = BrokenConstraints(margins, limits);
  return broken.empty() ? std::nullopt : std::optional(broken.front());
}

}  // namespace elastocal
