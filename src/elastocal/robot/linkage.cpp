// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/linkage.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "elastocal/math/decompositions.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/robot/robot_tree.hpp"
#include "elastocal/robot/rod_loop.hpp"

namespace elastocal {
namespace {

using Eigen::Vector3d;

constexpr int kMostSteps = 50;        // of Newton's method
constexpr double kClosed = 1e-13;     // m: how well a loop is closed
constexpr double kLongestStep = 0.2;  // rad, of Newton's method
constexpr double kMotorStep = 0.05;   // rad or m: step of a motor on the way to its position
constexpr double kLeastLever = 1e-4;  // m/rad: by which the rods move the joints

std::string Quoted(const std::string& name) { return "'" + name + "'"; }

void CheckJoints(const Linkage& linkage, const RobotTree& tree) {
  const std::string name = "linkage " + Quoted(linkage.name);
  if (linkage.joints.size() != linkage.rods.size() || linkage.joints.empty()) {
    throw InputError(name + " has " + std::to_string(linkage.joints.size()) + " joints and " +
                     std::to_string(linkage.rods.size()) +
                     " rods; one rod for each joint expected");
  }
  for (const Linkage& other : tree.linkages) {
    for (int k : linkage.joints) {
      if (std::find(other.joints.begin(), other.joints.end(), k) == other.joints.end()) continue;
      throw InputError("joint " + Quoted(tree.joints[k].name) + " belongs to linkage " +
                       Quoted(other.name) + " already");
    }
  }
  for (std::size_t j = 0; j < linkage.joints.size(); ++j) {
    const int k = linkage.joints[j];
    const Joint& joint = tree.joints[k];
    if (std::count(linkage.joints.begin(), linkage.joints.end(), k) > 1) {
      throw InputError("joint " + Quoted(joint.name) + " comes twice");
    }
    if (joint.type != JointType::kRevolute) {
      throw InputError("joint " + Quoted(joint.name) + " is prismatic; rods move revolute joints");
    }
    constexpr const char* kNeither =
        " (coupling or mimic); a joint of a linkage neither follows nor leads";
    if (joint.mimic) {
      throw InputError("joint " + Quoted(joint.name) + " follows another joint" + kNeither);
    }
    for (std::size_t other = 0; other < tree.joints.size(); ++other) {
      if (static_cast<int>(other) == k || !IsMovedBy(tree.joints[other], joint.coordinate))
        continue;
      throw InputError("joint " + Quoted(joint.name) + " is followed by joint " +
                       Quoted(tree.joints[other].name) + kNeither);
    }
  }
}

void CheckRod(const Linkage& linkage, const Rod& rod, const RobotTree& tree) {
  const std::string who = "the rod of motor " + Quoted(rod.motor);
  const int from = tree.links[rod.from_link].body, to = tree.links[rod.to_link].body;
  const std::vector<int> path = JointsToBody(tree, to);
  const auto carried = std::find(path.begin(), path.end(), from - 1);
  if (from == to || (from > 0 && carried == path.end())) {
    throw InputError(who + ": link " + Quoted(tree.links[rod.from_link].name) +
                     " does not carry link " + Quoted(tree.links[rod.to_link].name) + " on joints");
  }
  for (auto k = from > 0 ? carried + 1 : path.begin(); k != path.end(); ++k) {
    if (std::find(linkage.joints.begin(), linkage.joints.end(), *k) == linkage.joints.end()) {
      throw InputError(who + ": joint " + Quoted(tree.joints[*k].name) + " between links " +
                       Quoted(tree.links[rod.from_link].name) + " and " +
                       Quoted(tree.links[rod.to_link].name) + " is not of the linkage");
    }
  }
  if (!rod.actuator && !(CrankOf(rod).radius > kLeastLever)) {
    throw InputError(who + ": the pin lies on the axis of the crank");
  }
}

/// Millimetres for messages.
std::string InMm(double metres) {
  return std::to_string(static_cast<int>(std::lround(1e3 * metres))) + " mm";
}

[[noreturn]] void FailReach(const RobotTree& tree, const Linkage& linkage, const Rod& rod) {
  const Vector3d anchor = PlaceLinks(tree, linkage, rod, linkage.assembled).T_from_to * rod.anchor;
  const Crank crank = CrankOf(rod);
  const Vector3d w = anchor - crank.middle;
  const double along = w.dot(rod.axis);
  const double across = (w - along * rod.axis).norm();
  throw InputError("the rod of motor " + Quoted(rod.motor) + " is " + InMm(rod.length) +
                   " long and cannot reach: with the joints at rest, its anchor is between " +
                   InMm(std::hypot(across - crank.radius, along)) + " and " +
                   InMm(std::hypot(across + crank.radius, along)) + " from the pin of the crank");
}

}  // namespace

const char* RodQuantityName(RodQuantity quantity) {
  static constexpr const char* kNames[] = {"length",   "zero",     "radius",
                                           "anchor_x", "anchor_y", "anchor_z",
                                           "centre_x", "centre_y", "centre_z"};
  return kNames[static_cast<int>(quantity)];
}

int Linkage::error_count() const {
  std::size_t count = 0;
  for (const Rod& rod : rods) count += rod.uncertain.size();
  return static_cast<int>(count);
}

void AddLinkage(Linkage linkage, RobotTree& tree) {
  CheckJoints(linkage, tree);
  const auto size = static_cast<Eigen::Index>(linkage.joints.size());
  for (Rod& rod : linkage.rods) {
    CheckRod(linkage, rod, tree);
    if (rod.length == 0.0) {
      const RodLoop loop = EvaluateLoop(tree, linkage, rod, 0.0, Eigen::VectorXd::Zero(size));
      rod.length = loop.gap;
    }
    if (rod.actuator) continue;
    const auto one = MotorOf(tree, linkage, rod, linkage.assembled, 1.0);
    const auto other = MotorOf(tree, linkage, rod, linkage.assembled, -1.0);
    if (!one || !other) FailReach(tree, linkage, rod);
    rod.branch = std::abs(*one) <= std::abs(*other) ? 1.0 : -1.0;
  }
  const auto motors = MotorPositions(tree, linkage, linkage.assembled);
  const Eigen::MatrixXd J = ByJoints(EvaluateLoops(tree, linkage, *motors, linkage.assembled));
  if (!(SingularValues(J).minCoeff() > kLeastLever)) {
    throw InputError("the rods of linkage " + Quoted(linkage.name) +
                     " cannot move its joints: they pass by the axes, or two do the same");
  }
  tree.linkages.push_back(std::move(linkage));
}

std::optional<Eigen::VectorXd> MotorPositions(const RobotTree& tree, const Linkage& linkage,
                                              const Eigen::VectorXd& positions) {
  Eigen::VectorXd motors(static_cast<Eigen::Index>(linkage.rods.size()));
  for (std::size_t i = 0; i < linkage.rods.size(); ++i) {
    const Rod& rod = linkage.rods[i];
    const auto motor = MotorOf(tree, linkage, rod, positions, rod.branch);
    if (!motor) return std::nullopt;
    motors[static_cast<Eigen::Index>(i)] = *motor;
  }
  return motors;
}

Eigen::VectorXd LoopGaps(const RobotTree& tree, const Linkage& linkage,
                         const Eigen::VectorXd& motors, const Eigen::VectorXd& positions) {
  return GapsOf(EvaluateLoops(tree, linkage, motors, positions));
}

Linkage WithErrors(const Linkage& linkage, const Eigen::VectorXd& errors) {
  Linkage with = linkage;
  if (errors.size() == 0) return with;
  const double* at = errors.data();
  for (Rod& rod : with.rods) {
    rod = WithErrorsOfRod(rod, at);
    at += rod.uncertain.size();
  }
  return with;
}

std::optional<Closure> CloseLinkage(const RobotTree& tree, const Linkage& linkage,
                                    const Eigen::VectorXd& motors, const Eigen::VectorXd& errors,
                                    const Eigen::VectorXd& start) {
  const Linkage with = WithErrors(linkage, errors);
  const auto size = static_cast<Eigen::Index>(with.rods.size());
  Closure closure{start, {}, {}};
  for (int step = 0; step < kMostSteps; ++step) {
    const std::vector<RodLoop> loops = EvaluateLoops(tree, with, motors, closure.positions);
    const Eigen::VectorXd gaps = GapsOf(loops);
    const Eigen::PartialPivLU<Eigen::MatrixXd> inverse(ByJoints(loops));
    if (gaps.lpNorm<Eigen::Infinity>() < kClosed) {
      Eigen::MatrixXd by_errors = Eigen::MatrixXd::Zero(size, with.error_count());
      Eigen::MatrixXd by_motors = Eigen::MatrixXd::Zero(size, size);
      Eigen::Index at = 0;
      for (Eigen::Index i = 0; i < size; ++i) {
        const RodLoop& loop = loops[static_cast<std::size_t>(i)];
        by_errors.block(i, at, 1, loop.by_errors.size()) = loop.by_errors;
        by_motors(i, i) = loop.by_motor;
        at += loop.by_errors.size();
      }
      closure.by_errors = -inverse.solve(by_errors);
      closure.by_motors = -inverse.solve(by_motors);
      if (!closure.by_errors.allFinite() || !closure.by_motors.allFinite()) return std::nullopt;
      return closure;
    }
    Eigen::VectorXd change = -inverse.solve(gaps);
    if (!change.allFinite()) return std::nullopt;
    const double longest = change.lpNorm<Eigen::Infinity>();
    if (longest > kLongestStep) change *= kLongestStep / longest;
    closure.positions += change;
  }
  return std::nullopt;
}

std::optional<Eigen::VectorXd> JointsFromMotors(const RobotTree& tree, const Linkage& linkage,
                                                const Eigen::VectorXd& motors) {
  const auto begin = MotorPositions(tree, linkage, linkage.assembled);
  if (!begin || !motors.allFinite()) return std::nullopt;
  const Eigen::VectorXd way = motors - *begin;
  const int steps =
      1 + static_cast<int>(std::min(200.0, way.lpNorm<Eigen::Infinity>() / kMotorStep));
  Eigen::VectorXd positions = linkage.assembled;
  for (int step = 1; step <= steps; ++step) {
    const Eigen::VectorXd at = *begin + static_cast<double>(step) / steps * way;
    const auto closure = CloseLinkage(tree, linkage, at, {}, positions);
    if (!closure) return std::nullopt;
    positions = closure->positions;
  }
  const auto back = MotorPositions(tree, linkage, positions);
  constexpr double kSame = 1e-6;  // rad or m
  if (!back || (*back - motors).lpNorm<Eigen::Infinity>() > kSame) return std::nullopt;
  return positions;
}

double LeverShare(const RobotTree& tree, const Linkage& linkage, const Eigen::VectorXd& positions) {
  const auto lever = [&](const Eigen::VectorXd& at) {
    const auto motors = MotorPositions(tree, linkage, at);
    return motors ? LeastLever(EvaluateLoops(tree, linkage, *motors, at)) : 0.0;
  };
  return lever(positions) / lever(linkage.assembled);
}

bool IsMovedByRods(const RobotTree& tree, int joint) {
  return std::any_of(tree.linkages.begin(), tree.linkages.end(), [&](const Linkage& linkage) {
    return std::find(linkage.joints.begin(), linkage.joints.end(), joint) != linkage.joints.end();
  });
}

std::vector<int> CoordinatesOf(const RobotTree& tree, const Linkage& linkage) {
  std::vector<int> coordinates;
  for (int k : linkage.joints) coordinates.push_back(tree.joints[k].coordinate);
  return coordinates;
}

bool LinkagesClose(const RobotTree& tree, const Eigen::VectorXd& q) {
  return std::all_of(tree.linkages.begin(), tree.linkages.end(), [&](const Linkage& linkage) {
    return MotorPositions(tree, linkage, q(CoordinatesOf(tree, linkage))).has_value();
  });
}

}  // namespace elastocal
