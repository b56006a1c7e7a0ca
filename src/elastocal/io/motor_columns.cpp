// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/motor_columns.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "elastocal/io/recording_columns.hpp"
#include "elastocal/math/decompositions.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr const char* kMotorEndings[] = {"", "_position", "_torque", "_effort"};

bool HasColumn(const std::vector<std::string>& columns, const std::string& motor) {
  return std::any_of(std::begin(kMotorEndings), std::end(kMotorEndings), [&](const char* ending) {
    return std::find(columns.begin(), columns.end(), motor + ending) != columns.end();
  });
}

/// Gives the joints of a linkage the names of its motors.
void NameAsMotors(const Linkage& linkage, Project& project) {
  for (std::size_t i = 0; i < linkage.rods.size(); ++i) {
    Joint& joint = project.tree.joints[static_cast<std::size_t>(linkage.joints[i])];
    const std::string column = JointColumn(project, joint.name);
    for (const char* ending : kMotorEndings) project.recording.ignore.push_back(column + ending);
    project.recording.joints.erase(joint.name);
    joint.name = linkage.rods[i].motor;
    joint.type = linkage.rods[i].actuator ? JointType::kPrismatic : JointType::kRevolute;
  }
}

/// Closes a linkage from a start nearby or, if that fails, from Linkage::assembled.
std::optional<Closure> CloseNear(const RobotTree& tree, const Linkage& linkage,
                                 const Eigen::VectorXd& motors, const Eigen::VectorXd& start) {
  constexpr double kSame = 1e-6;  // rad or m
  const auto near = CloseLinkage(tree, linkage, motors, {}, start);
  if (near) {
    const auto back = MotorPositions(tree, linkage, near->positions);
    if (back && (*back - motors).lpNorm<Eigen::Infinity>() < kSame) return near;
  }
  const auto positions = JointsFromMotors(tree, linkage, motors);
  if (!positions) return std::nullopt;
  return CloseLinkage(tree, linkage, motors, {}, *positions);
}

/// The columns of the log with these names; nothing if one is missing.
std::optional<std::vector<int>> ColumnsOf(const std::vector<std::string>& names,
                                          const JointLog& log) {
  std::vector<int> columns;
  for (const std::string& name : names) {
    const auto found = std::find(log.names.begin(), log.names.end(), name);
    if (found == log.names.end()) return std::nullopt;
    columns.push_back(static_cast<int>(found - log.names.begin()));
  }
  return columns;
}

/// Whether the loops close in all of at most so many rows, evenly spread, and in the row `one`.
bool ClosesInAll(const RobotTree& tree, const Linkage& linkage, const Eigen::MatrixXd& motors,
                 Eigen::Index one) {
  constexpr Eigen::Index kMostRows = 100;
  if (!JointsFromMotors(tree, linkage, motors.row(one).transpose())) return false;
  for (Eigen::Index row = 0; row < motors.rows(); row += 1 + motors.rows() / kMostRows) {
    if (!JointsFromMotors(tree, linkage, motors.row(row).transpose())) return false;
  }
  return true;
}

/// Changes of the motors' columns with which the loops close: "with the sign of 'a' reversed, or
/// with 'a' and 'b' exchanged"; empty if none helps.
std::string WhatWouldClose(const RobotTree& tree, const Linkage& linkage,
                           const Eigen::MatrixXd& motors, Eigen::Index failed) {
  std::string found;
  const auto attempt = [&](const Eigen::MatrixXd& changed, const std::string& what) {
    if (!ClosesInAll(tree, linkage, changed, failed)) return;
    found += (found.empty() ? "with " : ", or with ") + what;
  };
  const auto name = [&](Eigen::Index i) { return Quote(linkage.rods[Size(i)].motor); };
  for (Eigen::Index i = 0; i < motors.cols(); ++i) {
    Eigen::MatrixXd changed = motors;
    changed.col(i) *= -1.0;
    attempt(changed, "the sign of " + name(i) + " reversed");
    for (Eigen::Index k = 0; k < i; ++k) {
      changed = motors;
      changed.col(i).swap(changed.col(k));
      attempt(changed, name(k) + " and " + name(i) + " exchanged");
    }
  }
  const bool turns = std::none_of(linkage.rods.begin(), linkage.rods.end(),
                                  [](const Rod& rod) { return rod.actuator; });
  const bool may_be_degrees = motors.cwiseAbs().maxCoeff() > 2.0 * M_PI;
  if (turns && may_be_degrees) attempt(motors * (M_PI / 180.0), "degrees read as such");
  return found;
}

std::vector<std::string> MotorNames(const Linkage& linkage) {
  std::vector<std::string> names;
  for (const Rod& rod : linkage.rods) names.push_back(rod.motor);
  return names;
}

std::vector<std::string> JointNames(const RobotTree& tree, const Linkage& linkage) {
  std::vector<std::string> names;
  for (int k : linkage.joints) names.push_back(tree.joints[static_cast<std::size_t>(k)].name);
  return names;
}

Eigen::VectorXd MotorsAt(const RobotTree& tree, const Linkage& linkage,
                         const Eigen::VectorXd& positions) {
  if (const auto motors = MotorPositions(tree, linkage, positions)) return *motors;
  std::string where;
  for (std::size_t i = 0; i < linkage.joints.size(); ++i) {
    where += (i == 0 ? "joint " : " and joint ") + Quote(JointNames(tree, linkage)[i]) + " at " +
             FormatNumber(positions[static_cast<Eigen::Index>(i)]) + " rad";
  }
  throw InputError(where + ": the rods of linkage " + Quote(linkage.name) + " do not reach there");
}

void Rename(const std::vector<int>& columns, const std::vector<std::string>& names, JointLog& log) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    log.names[static_cast<std::size_t>(columns[i])] = names[i];
  }
}

}  // namespace

Project WithMotors(const Project& project, const std::vector<std::string>& columns,
                   const std::string& source) {
  Project with = project;
  for (const Linkage& linkage : project.tree.linkages) {
    const Rod* there = nullptr;
    const Rod* missing = nullptr;
    for (const Rod& rod : linkage.rods) (HasColumn(columns, rod.motor) ? there : missing) = &rod;
    if (there == nullptr) continue;
    if (missing != nullptr) {
      throw InputError(source + ": there is a column of the motor " + Quote(there->motor) +
                       " and none of " + Quote(missing->motor) +
                       "; those of all motors of linkage " + Quote(linkage.name) +
                       " were expected");
    }
    NameAsMotors(linkage, with);
  }
  return with;
}

std::string OrItsMotors(const RobotTree& tree, int joint) {
  for (const Linkage& linkage : tree.linkages) {
    const auto& joints = linkage.joints;
    if (std::find(joints.begin(), joints.end(), joint) == joints.end()) continue;
    std::string names;
    for (const Rod& rod : linkage.rods) names += (names.empty() ? "" : ", ") + Quote(rod.motor);
    return " (or those of its motors " + names + ")";
  }
  return "";
}

Eigen::Index MotorsToJoints(const RobotTree& tree, const Linkage& linkage,
                            const std::vector<int>& columns, Eigen::MatrixXd& table,
                            std::vector<Eigen::MatrixXd>* by_motors) {
  Eigen::VectorXd last = linkage.assembled;
  for (Eigen::Index row = 0; row < table.rows(); ++row) {
    const auto closure = CloseNear(tree, linkage, table(row, columns).transpose(), last);
    if (!closure) return row;
    last = closure->positions;
    table(row, columns) = last.transpose();
    if (by_motors != nullptr) by_motors->push_back(closure->by_motors);
  }
  return -1;
}

std::string CannotClose(const RobotTree& tree, const Linkage& linkage,
                        const Eigen::MatrixXd& motors, Eigen::Index failed) {
  std::string text;
  for (std::size_t i = 0; i < linkage.rods.size(); ++i) {
    const Rod& rod = linkage.rods[i];
    text += std::string(i == 0 ? "motor " : " and motor ") + Quote(rod.motor) + " at " +
            FormatNumber(motors(failed, static_cast<Eigen::Index>(i))) +
            (rod.actuator ? " m" : " rad");
  }
  text += ": the rods of linkage " + Quote(linkage.name) +
          " do not reach there; positions at which its loops close were expected";
  const std::string cause = WhatWouldClose(tree, linkage, motors, failed);
  return cause.empty() ? text : text + " (they would close " + cause + ")";
}

void MotorsToJoints(const RobotTree& tree, JointLog& log) {
  for (const Linkage& linkage : tree.linkages) {
    const auto columns = ColumnsOf(MotorNames(linkage), log);
    if (!columns) continue;
    const Eigen::MatrixXd motors = log.positions;
    std::vector<Eigen::MatrixXd> by_motors;
    const Eigen::Index failed = MotorsToJoints(tree, linkage, *columns, log.positions, &by_motors);
    if (failed >= 0) {
      throw InputError(log.source + ": sample " + std::to_string(failed + 1) + ": " +
                       CannotClose(tree, linkage, motors(Eigen::all, *columns), failed));
    }
    for (Eigen::Index row = 0; row < log.torques.rows(); ++row) {
      const Eigen::VectorXd torques = log.torques(row, *columns).transpose();
      if (!torques.allFinite()) {
        log.torques(row, *columns).setConstant(kNaN);
        continue;
      }
      const Eigen::MatrixXd& by = by_motors[static_cast<std::size_t>(row)];
      log.torques(row, *columns) = ShortestSolution(by.transpose(), torques).transpose();
    }
    Rename(*columns, JointNames(tree, linkage), log);
  }
}

JointLog JointsToMotors(const RobotTree& tree, JointLog log) {
  for (const Linkage& linkage : tree.linkages) {
    const auto columns = ColumnsOf(JointNames(tree, linkage), log);
    if (!columns) continue;
    for (Eigen::Index row = 0; row < log.positions.rows(); ++row) {
      const Eigen::VectorXd joints = log.positions(row, *columns).transpose();
      const Eigen::VectorXd motors = MotorsAt(tree, linkage, joints);
      const Eigen::VectorXd torques = log.torques(row, *columns).transpose();
      const auto closure = CloseLinkage(tree, linkage, motors, {}, joints);
      log.positions(row, *columns) = motors.transpose();
      log.torques(row, *columns).setConstant(kNaN);
      if (!closure) continue;
      log.torques(row, *columns) = (closure->by_motors.transpose() * torques).transpose();
    }
    Rename(*columns, MotorNames(linkage), log);
  }
  return log;
}

RobotTree JointsToMotors(const RobotTree& tree, const std::vector<std::string>& absent,
                         Eigen::MatrixXd& q) {
  RobotTree named = tree;
  for (const Linkage& linkage : tree.linkages) {
    const std::vector<std::string> names = JointNames(tree, linkage);
    const bool all = std::none_of(names.begin(), names.end(), [&](const std::string& name) {
      return std::find(absent.begin(), absent.end(), name) != absent.end();
    });
    if (!all) continue;
    const std::vector<int> columns = CoordinatesOf(tree, linkage);
    for (Eigen::Index row = 0; row < q.rows(); ++row) {
      q(row, columns) = MotorsAt(tree, linkage, q(row, columns).transpose()).transpose();
    }
    for (std::size_t i = 0; i < columns.size(); ++i) {
      named.joints[static_cast<std::size_t>(linkage.joints[i])].name = linkage.rods[i].motor;
    }
  }
  return named;
}

}  // namespace elastocal
