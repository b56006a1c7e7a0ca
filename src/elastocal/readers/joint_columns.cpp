// SPDX-License-Identifier: Apache-2.0
#include "elastocal/readers/joint_columns.hpp"

#include <cmath>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/utf8.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

using Column = std::vector<double>;

/// The name without the ending, where it has it.
bool TakeEnding(std::string& name, std::string_view ending) {
  if (!name.ends_with(ending) || name.size() == ending.size()) return false;
  name.resize(name.size() - ending.size());
  return true;
}

Eigen::VectorXd ToVector(const Column& column) {
  return Eigen::Map<const Eigen::VectorXd>(column.data(), static_cast<Eigen::Index>(column.size()));
}

void AddOnce(const std::string& source, const std::string& joint, const char* what, Column& column,
             std::map<std::string, Column>& columns) {
  if (columns.try_emplace(joint, std::move(column)).second) return;
  throw InputError(source + ": two columns have the " + what + " of joint " + Quote(joint));
}

}  // namespace

std::string PlainColumnName(const std::string& name) {
  if (!name.starts_with('/')) return name;
  if (name.find("/header/") != std::string::npos) return "";
  std::string path = name;
  for (const char* quantity : {"position", "effort", "torque", "velocity"}) {
    if (!TakeEnding(path, std::string("/") + quantity)) continue;
    const std::string joint = path.substr(path.rfind('/') + 1);
    return joint.empty() ? name : joint + "_" + quantity;
  }
  return name;
}

JointLog JoinColumns(const std::string& source, const std::vector<double>& time,
                     std::map<std::string, std::vector<double>>&& columns) {
  std::map<std::string, Column> positions, torques;
  for (auto& [name, column] : columns) {
    std::string joint = name;
    if (TakeEnding(joint, "_velocity")) continue;
    if (TakeEnding(joint, "_torque") || TakeEnding(joint, "_effort")) {
      AddOnce(source, joint, "torques", column, torques);
    } else {
      TakeEnding(joint, "_position");
      AddOnce(source, joint, "positions", column, positions);
    }
  }
  return JoinJoints(source, time, std::move(positions), std::move(torques));
}

JointLog JoinJoints(const std::string& source, const std::vector<double>& time,
                    std::map<std::string, std::vector<double>>&& positions,
                    std::map<std::string, std::vector<double>>&& torques) {
  for (const auto& [joint, column] : positions) RequireUtf8(joint, source);
  for (const auto& [joint, column] : torques) {
    RequireUtf8(joint, source);
    if (positions.contains(joint)) continue;
    throw InputError(source + ": there are torques of joint " + Quote(joint) +
                     ", whose positions are missing");
  }
  JointLog log;
  log.source = source;
  log.time_s = ToVector(time);
  const auto samples = log.time_s.size();
  const auto count = static_cast<Eigen::Index>(positions.size());
  log.positions.resize(samples, count);
  // What has been copied is freed, so that a large log is in memory little more than once.
  for (auto& [joint, column] : positions) {
    log.positions.col(static_cast<Eigen::Index>(log.names.size())) = ToVector(column);
    column = Column();
    log.names.push_back(joint);
  }
  log.torques.setConstant(samples, count, kNaN);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto torque = torques.find(log.names[static_cast<std::size_t>(i)]);
    if (torque == torques.end()) continue;
    log.torques.col(i) = ToVector(torque->second);
    torque->second = Column();
  }
  CheckJointLog(log);
  return log;
}

void CheckJointLog(const JointLog& log) {
  const auto fail = [&](Eigen::Index sample, const std::string& message) {
    throw InputError(log.source + ": sample " + std::to_string(sample + 1) + ": " + message);
  };
  for (Eigen::Index i = 0; i < log.time_s.size(); ++i) {
    if (!std::isfinite(log.time_s[i])) fail(i, "the time is not finite");
    if (i > 0 && log.time_s[i] <= log.time_s[i - 1]) {
      fail(i, "the time " + FormatNumber(log.time_s[i]) + " s is not above the last one, " +
                  FormatNumber(log.time_s[i - 1]) + " s");
    }
    for (Eigen::Index k = 0; k < log.positions.cols(); ++k) {
      if (std::isfinite(log.positions(i, k))) continue;
      fail(i, "the position of joint " + Quote(log.names[static_cast<std::size_t>(k)]) +
                  " is not finite");
    }
  }
}

}  // namespace elastocal
