// SPDX-License-Identifier: Apache-2.0
#include "elastocal/motion/standing_robot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/rotation_vector.hpp"

namespace elastocal {
namespace {

Eigen::Vector3d SoleCentre(const Sole& sole, const Transform& T_world_sole) {
  const Eigen::Vector2d centre = sole.centre();
  return T_world_sole * Eigen::Vector3d(centre.x(), centre.y(), 0.0);
}

/// Places a leg. If it has too few joints of its own, the sole may turn about its normal.
bool PlaceLeg(const LegChain& leg, const Transform& T_root_sole, Eigen::VectorXd& q) {
  return leg.turns_root() ? leg.PlaceFlat(T_root_sole, q) : leg.Place(T_root_sole, q);
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
      if (!PlaceLeg(leg, T_root_sole, bent)) continue;
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

/// Height of the root link above the floor, m: that of the posture if its knees are bent, otherwise
/// that of straight legs less the drop.
double RootHeight(const StandingRobot& robot, const Eigen::VectorXd& posture,
                  const StandOptions& options) {
  double bend = 0.0;
  for (const int c : robot.legs[0].coordinates()) bend = std::max(bend, std::abs(posture[c]));
  const double foot = robot.soles[0].height();
  if (bend > robot.limits.least_knee) {
    return foot - robot.legs[0].SolePose(posture).translation().z();
  }
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(posture.size());
  return foot - (1.0 - options.drop) * robot.legs[0].SolePose(zero).translation().z();
}

/// The supports on the fewest feet.
std::vector<std::vector<int>> FewestFeet(const StandingRobot& robot) {
  std::vector<std::vector<int>> supports;
  if (robot.soles.size() == 1) return {{0}};
  for (int foot = static_cast<int>(robot.soles.size()); foot-- > 0;) {
    supports.push_back(robot.AllFeetBut(foot));
  }
  return supports;
}

/// Least distance from the middle of a support on the fewest feet to its edge, m.
double HalfSupport(const StandingRobot& robot) {
  double least = std::numeric_limits<double>::infinity();
  for (const std::vector<int>& feet : FewestFeet(robot)) {
    if (feet.size() == 1) {
      const Sole& sole = robot.soles[Size(feet[0])];
      least = std::min(least, 0.5 * (sole.upper - sole.lower).minCoeff());
      continue;
    }
    std::vector<Sole> soles;
    std::vector<Transform> T_world_sole;
    for (const int foot : feet) {
      soles.push_back(robot.soles[Size(foot)]);
      T_world_sole.push_back(robot.T_world_sole[Size(foot)]);
    }
    least = std::min(least,
                     InsideMargin(SupportPolygon(soles, T_world_sole), SupportCentre(robot, feet)));
  }
  return least;
}

void SizeSupport(StandingRobot& robot) {
  constexpr double kZmpShare = 0.3;
  robot.half_support = HalfSupport(robot);
  if (robot.limits.zmp_margin < 0.0) robot.limits.zmp_margin = kZmpShare * robot.half_support;
}

/// Angle about the vertical by which a sole is turned from its pose on the floor, rad.
double HeadingOff(const StandingRobot& robot, int foot, const PlacedPosture& pose) {
  const Eigen::Matrix3d R = pose.T_world_root.linear() *
                            robot.legs[Size(foot)].SolePose(pose.q).linear() *
                            robot.T_world_sole[Size(foot)].linear().transpose();
  return RotationVector(R).z();
}

/// Pose in which a sole stands on the floor: under the root link as in the zero posture, or for a
/// ball as in `posture`.
Transform PlaceOnFloor(const StandingRobot& robot, int foot, const Eigen::VectorXd& posture) {
  constexpr double kUpright = 0.01;
  const Sole& sole = robot.soles[Size(foot)];
  const bool ball = sole.ball_radius.has_value();
  Transform T_world_sole =
      robot.legs[Size(foot)].SolePose(ball ? posture : Eigen::VectorXd::Zero(posture.size()));
  T_world_sole.translation().z() = sole.height();
  if (!ball && (T_world_sole.linear().col(2) - Eigen::Vector3d::UnitZ()).norm() > kUpright) {
    throw InputError(
        "robot '" + robot.tree.name + "': sole '" + robot.tree.links[Size(sole.link)].name +
        "' does not lie flat in the zero posture; a frame with z upwards was expected");
  }
  return T_world_sole;
}

/// Whether the standing feet are in their places on the floor, and the others not below it.
bool FitsTheFloor(const StandingRobot& robot, const std::vector<int>& standing,
                  const Transform& T_world_root, const Eigen::VectorXd& q) {
  constexpr double kOff = 1e-3;  // m: a standing foot is off its place by less, from rounding
  const std::vector<int> feet = robot.AllFeet();
  return std::all_of(feet.begin(), feet.end(), [&](int foot) {
    const Eigen::Vector3d found = (T_world_root * robot.legs[Size(foot)].SolePose(q)).translation();
    const Eigen::Vector3d place = robot.T_world_sole[Size(foot)].translation();
    const bool stands = std::find(standing.begin(), standing.end(), foot) != standing.end();
    return found.z() >= place.z() - kOff && (!stands || (found - place).norm() <= kOff);
  });
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
  bool balls = false;
  for (const Sole& sole : soles) {
    legs.emplace_back(tree, sole, soles);
    knees.push_back(legs.back().coordinates().front());
    balls = balls || sole.ball_radius;
  }
  if (balls && soles.size() < 4) {
    throw InputError(
        "robot '" + tree.name + "' has " + std::to_string(soles.size()) +
        " feet, balls among them (a leg of fewer than five joints ends in one); expected "
        "four or more, of which three can stand while one is in the air");
  }
  if (Held()) return;
  leg_length = legs[0].length();
  if (soles.size() <= 2) SizeSupport(*this);
}

std::vector<int> StandingRobot::AllFeet() const {
  std::vector<int> feet;
  for (std::size_t i = 0; i < soles.size(); ++i) feet.push_back(static_cast<int>(i));
  return feet;
}

std::vector<int> StandingRobot::AllFeetBut(int swings) const {
  std::vector<int> feet = AllFeet();
  feet.erase(feet.begin() + swings);
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
  if (robot.Held()) {
    robot.rest = posture;
    return;
  }
  PlacedPosture pose{posture, Transform::Identity()};
  pose.T_world_root.translation().z() = RootHeight(robot, posture, options);
  robot.T_world_sole.clear();
  for (const int foot : robot.AllFeet()) {
    robot.T_world_sole.push_back(PlaceOnFloor(robot, foot, posture));
  }
  if (options.stance && robot.soles.size() == 2) {
    Widen(*options.stance, robot.soles, robot.T_world_sole);
  }
  if (robot.soles.size() > 2) SizeSupport(robot);  // its triangles are known now
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
  for (const int foot : feet) {
    const std::vector<int>& leg = robot.legs[Size(foot)].coordinates();
    robot.knees[Size(foot)] = *std::max_element(leg.begin(), leg.end(), [&](int a, int b) {
      return std::abs(robot.rest[a]) < std::abs(robot.rest[b]);
    });
  }
}

Eigen::Vector2d SupportCentre(const StandingRobot& robot, const std::vector<int>& feet) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  if (feet.empty()) return sum;
  for (const int foot : feet) {
    sum += SoleCentre(robot.soles[Size(foot)], robot.T_world_sole[Size(foot)]).head<2>();
  }
  return sum / static_cast<double>(feet.size());
}

bool PlaceFeet(const StandingRobot& robot, const std::vector<int>& feet, PlacedPosture& pose) {
  const auto place = [&] {
    return std::all_of(feet.begin(), feet.end(), [&](int foot) {
      const Transform& T_world_sole = robot.T_world_sole[Size(foot)];
      if (foot != feet.front()) return PlaceSole(robot, foot, T_world_sole, pose);
      return robot.legs[Size(foot)].PlaceUnderRoot(T_world_sole, pose.T_world_root, pose.q);
    });
  };
  if (!place()) return false;
  if (feet.size() < 2 || !robot.legs[Size(feet[1])].turns_root()) return true;
  // Secant steps of the shared joint, on the heading of the second foot.
  constexpr int kIterations = 20;
  constexpr double kReached = 1e-11, kLargestMove = 0.1;  // rad
  double& shared = pose.q[robot.legs[Size(feet[1])].shared_coordinates().back()];
  double off = HeadingOff(robot, feet[1], pose), step = std::min(kLargestMove, std::max(1e-4, off));
  for (int i = 0; i < kIterations; ++i) {
    if (std::abs(off) < kReached) return true;
    const double before = off;
    shared += step;
    if (!place()) return false;
    off = HeadingOff(robot, feet[1], pose);
    if (off == before) return false;
    step = std::clamp(-off * step / (off - before), -kLargestMove, kLargestMove);
  }
  return false;
}

bool PlaceSole(const StandingRobot& robot, int foot, const Transform& T_world_sole,
               PlacedPosture& pose) {
  return PlaceLeg(robot.legs[Size(foot)], pose.T_world_root.inverse() * T_world_sole, pose.q);
}

Transform RootOverFeet(const StandingRobot& robot, const std::vector<int>& feet,
                       const Eigen::VectorXd& q) {
  const auto first = Size(feet.front());
  if (!robot.soles[first].ball_radius) {
    return robot.T_world_sole[first] * robot.legs[first].SolePose(q).inverse();
  }
  Eigen::Matrix3Xd found(3, static_cast<Eigen::Index>(feet.size())), place = found;
  for (std::size_t i = 0; i < feet.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    found.col(column) = robot.legs[Size(feet[i])].SolePose(q).translation();
    place.col(column) = robot.T_world_sole[Size(feet[i])].translation();
  }
  return FitRigid(found, place);
}

Transform RootOnFloor(const StandingRobot& robot, const Eigen::VectorXd& q) {
  if (robot.Held()) return robot.T_world_root;
  const std::vector<std::vector<int>> supports = FewestFeet(robot);
  for (const std::vector<int>& standing : supports) {
    const Transform T_world_root = RootOverFeet(robot, standing, q);
    if (FitsTheFloor(robot, standing, T_world_root, q)) return T_world_root;
  }
  return RootOverFeet(robot, supports.front(), q);
}

bool BalanceAtRest(const StandingRobot& robot, const std::vector<int>& feet,
                   const Eigen::Vector2d& com, PlacedPosture& pose) {
  constexpr int kIterations = 30;
  constexpr double kReached = 1e-10;    // m
  constexpr double kLargestMove = 0.1;  // m
  for (int i = 0; i < kIterations; ++i) {
    if (!PlaceFeet(robot, feet, pose)) return false;
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
