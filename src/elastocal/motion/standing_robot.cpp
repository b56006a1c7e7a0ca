// SPDX-License-Identifier: Apache-2.0
#include "elastocal/motion/standing_robot.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

Eigen::Vector3d SoleCentre(const Sole& sole, const Transform& T_world_sole) {
  const Eigen::Vector2d centre = sole.centre();
  return T_world_sole * Eigen::Vector3d(centre.x(), centre.y(), 0.0);
}

/// Bends a straight leg, the knee one way or the other, until the sole is in place.
bool Bend(const LegChain& leg, const RobotTree& tree, const Transform& T_root_sole,
          double position_margin, Eigen::VectorXd& q) {
  // Any of the middle joints may be the knee. Newton's steps keep the direction of bend with which
  // they begin.
  const std::vector<int>& joints = leg.coordinates();
  for (const double bend : {0.5, -0.5}) {
    for (std::size_t knee = 1; knee + 1 < joints.size(); ++knee) {
      Eigen::VectorXd bent = q;
      bent[joints[knee - 1]] -= 0.5 * bend;
      bent[joints[knee]] += bend;
      bent[joints[knee + 1]] -= 0.5 * bend;
      if (!leg.Place(T_root_sole, bent)) continue;
      const bool within = std::all_of(joints.begin(), joints.end(), [&](int i) {
        const JointLimits& limits = tree.joints[Size(tree.coordinate_joint[Size(i)])].limits;
        return bent[i] > limits.lower + position_margin && bent[i] < limits.upper - position_margin;
      });
      if (!within) continue;
      q = bent;
      return true;
    }
  }
  return false;
}

/// Height of the root link above the soles: of the posture, if its knees are bent, and otherwise
/// that of straight legs less the drop.
double RootHeight(const StandingRobot& robot, const Eigen::VectorXd& posture,
                  const StandOptions& options) {
  double bend = 0.0;
  for (const int c : robot.legs[0].coordinates()) bend = std::max(bend, std::abs(posture[c]));
  if (bend > robot.limits.least_knee) return -robot.legs[0].SolePose(posture).translation().z();
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(posture.size());
  return -(1.0 - options.drop) * robot.legs[0].SolePose(zero).translation().z();
}

/// Moves two soles apart, or together, until their centres have the distance `stance`.
void Widen(double stance, const std::vector<Sole>& soles, std::vector<Transform>& T_world_sole) {
  const Eigen::Vector3d between =
      SoleCentre(soles[1], T_world_sole[1]) - SoleCentre(soles[0], T_world_sole[0]);
  const Eigen::Vector3d half = 0.5 * (stance / between.norm() - 1.0) * between;
  T_world_sole[0].pretranslate(-half);
  T_world_sole[1].pretranslate(half);
}

}  // namespace

StandingRobot::StandingRobot(RobotTree robot, std::vector<Sole> feet, const MotionLimits& kept)
    : tree(std::move(robot)), inertias(BodyInertias(tree)), soles(std::move(feet)), limits(kept) {
  if (soles.size() > 2) {
    throw InputError("robot '" + tree.name + "' has " + std::to_string(soles.size()) +
                     " feet; expected one or two to balance on, or none");
  }
  for (const Sole& sole : soles) {
    legs.emplace_back(tree, sole.link);
    const double half = 0.5 * (sole.upper - sole.lower).minCoeff();
    half_sole = legs.size() == 1 ? half : std::min(half_sole, half);
  }
  if (Held()) return;
  leg_length = legs[0].length();
  constexpr double kZmpShare = 0.3;
  if (limits.zmp_margin < 0.0) limits.zmp_margin = kZmpShare * half_sole;
}

std::vector<int> StandingRobot::AllFeet() const {
  std::vector<int> feet;
  for (std::size_t i = 0; i < soles.size(); ++i) feet.push_back(static_cast<int>(i));
  return feet;
}

Eigen::VectorXd NeutralPosture(const RobotTree& tree, double position_margin) {
  Eigen::VectorXd q = Eigen::VectorXd::Zero(tree.coordinate_count());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const JointLimits& limits =
        tree.joints[Size(tree.coordinate_joint[static_cast<std::size_t>(i)])].limits;
    const double lower = limits.lower + position_margin, upper = limits.upper - position_margin;
    q[i] = lower < upper ? std::clamp(0.0, lower, upper) : 0.5 * (lower + upper);
  }
  return q;
}

void StandUp(StandingRobot& robot, const Eigen::VectorXd& posture, const StandOptions& options) {
  constexpr double kUpright = 0.01;
  if (robot.Held()) {
    robot.rest = posture;
    return;
  }
  const auto T_root_link =
      LinkTransforms(robot.tree, Eigen::VectorXd::Zero(robot.tree.coordinate_count()));
  PlacedPosture pose{posture, Transform::Identity()};
  pose.T_world_root.translation().z() = RootHeight(robot, posture, options);
  robot.T_world_sole.clear();
  for (std::size_t i = 0; i < robot.soles.size(); ++i) {
    const std::string& name = robot.tree.links[Size(robot.soles[i].link)].name;
    Transform T_world_sole = T_root_link[Size(robot.soles[i].link)];
    if ((T_world_sole.linear().col(2) - Eigen::Vector3d::UnitZ()).norm() > kUpright) {
      throw InputError(
          "robot '" + robot.tree.name + "': sole '" + name +
          "' does not lie flat in the zero posture; a frame with z upwards was expected");
    }
    T_world_sole.translation().z() = 0.0;
    robot.T_world_sole.push_back(T_world_sole);
  }
  if (options.stance && robot.soles.size() == 2) {
    Widen(*options.stance, robot.soles, robot.T_world_sole);
  }
  for (std::size_t i = 0; i < robot.soles.size(); ++i) {
    const Transform& T_world_sole = robot.T_world_sole[i];
    const std::string& name = robot.tree.links[Size(robot.soles[i].link)].name;
    if (!Bend(robot.legs[i], robot.tree, pose.T_world_root.inverse() * T_world_sole,
              robot.limits.position_margin, pose.q)) {
      throw InputError("the leg of '" + name + "' cannot stand bent on a level floor" +
                       (options.stance ? ", its feet as far apart as the stance asks" : ""));
    }
    robot.legs[i].Prefer(pose.q);
  }
  const std::vector<int> feet = robot.AllFeet();
  if (!BalanceAtRest(robot, feet, SupportCentre(robot, feet), pose)) {
    throw InputError("robot '" + robot.tree.name + "' cannot stand with its weight over its feet");
  }
  robot.rest = pose.q;
  robot.T_world_root = pose.T_world_root;
}

Eigen::Vector2d SupportCentre(const StandingRobot& robot, const std::vector<int>& feet) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  if (feet.empty()) return sum;
  for (const int foot : feet) {
    sum += SoleCentre(robot.soles[Size(foot)], robot.T_world_sole[Size(foot)]).head<2>();
  }
  return sum / static_cast<double>(feet.size());
}

bool PlaceSole(const StandingRobot& robot, int foot, const Transform& T_world_sole,
               PlacedPosture& pose) {
  return robot.legs[Size(foot)].Place(pose.T_world_root.inverse() * T_world_sole, pose.q);
}

Transform RootOnFoot(const StandingRobot& robot, int foot, const Eigen::VectorXd& q) {
  return robot.T_world_sole[Size(foot)] * robot.legs[Size(foot)].SolePose(q).inverse();
}

Transform RootOnFloor(const StandingRobot& robot, const Eigen::VectorXd& q) {
  constexpr double kBelow = 1e-3;  // m: a foot that stands too is there but for rounding
  if (robot.Held()) return robot.T_world_root;
  for (const int foot : robot.AllFeet()) {
    const Transform T_world_root = RootOnFoot(robot, foot, q);
    bool above = true;
    for (const int other : robot.AllFeet()) {
      const Transform T_world_sole = T_world_root * robot.legs[Size(other)].SolePose(q);
      const double floor = robot.T_world_sole[Size(other)].translation().z();
      above = above && T_world_sole.translation().z() > floor - kBelow;
    }
    if (above) return T_world_root;
  }
  return RootOnFoot(robot, 0, q);
}

bool BalanceAtRest(const StandingRobot& robot, const std::vector<int>& feet,
                   const Eigen::Vector2d& com, PlacedPosture& pose) {
  constexpr int kIterations = 30;
  constexpr double kReached = 1e-10;    // m
  constexpr double kLargestMove = 0.1;  // m
  for (int i = 0; i < kIterations; ++i) {
    for (const int foot : feet) {
      if (!PlaceSole(robot, foot, robot.T_world_sole[Size(foot)], pose)) return false;
    }
    const Eigen::Vector3d found =
        pose.T_world_root * CentreOfMass(robot.tree, robot.inertias, pose.q);
    // Most of the robot moves with the root link, and no part moves further.
    Eigen::Vector2d move = com - found.head<2>();
    if (move.norm() < kReached) return true;
    move *= std::min(1.0, kLargestMove / move.norm());
    pose.T_world_root.translation().head<2>() += move;
  }
  return false;
}

}  // namespace elastocal
