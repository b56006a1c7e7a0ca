#include "elastocal/io/joint_columns.hpp"

#include <map>

#include "elastocal/io/posture_columns.hpp"
#include "elastocal/io/text.hpp"
#include "elastocal/io/unknown_column.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

/// What a column name stands for in this project.
struct Role {
  enum class Kind { kTime, kPosition, kTorque, kWrench, kIgnored } kind = Kind::kIgnored;
  int index = 0;  ///< joint or, of a wrench, 6 x sensor + component
};

constexpr std::array kComponents = {"_fx", "_fy", "_fz", "_tx", "_ty", "_tz"};

using Roles = std::map<std::string, Role>;

Roles FindRoles(const Project& project) {
  const std::vector<Joint>& joints = project.tree.joints;
  const auto count = static_cast<int>(joints.size());
  const auto role = [&](Role::Kind kind, int k) {
    return Role{joints[k].mimic ? Role::Kind::kIgnored : kind, k};
  };
  Roles roles;
  roles[project.recording.time] = {Role::Kind::kTime};
  for (int k = 0; k < count; ++k) {
    const std::string column = JointColumn(project, joints[k].name);
    if (!roles.emplace(column, role(Role::Kind::kPosition, k)).second) {
      throw InputError(project.file.string() + ": the column " + Quote(column) +
                       " stands for two things; name one of them otherwise in recording.columns");
    }
  }
  // Where one of these is the name of another joint, it is that joint.
  roles.emplace("time", Role{Role::Kind::kTime});
  for (int k = 0; k < count; ++k) {
    const std::string column = JointColumn(project, joints[k].name);
    roles.emplace(column + "_position", role(Role::Kind::kPosition, k));
    roles.emplace(column + "_torque", role(Role::Kind::kTorque, k));
    roles.emplace(column + "_effort", role(Role::Kind::kTorque, k));
  }
  for (std::size_t i = 0; i < project.force_torque_sensors.size(); ++i) {
    for (std::size_t c = 0; c < kComponents.size(); ++c) {
      const int index = static_cast<int>(kComponents.size() * i + c);
      roles.emplace(project.force_torque_sensors[i].name + kComponents[c],
                    Role{Role::Kind::kWrench, index});
    }
  }
  for (const std::string& column : project.recording.ignore) roles[column] = Role{};
  return roles;
}

/// Keeps the joints whose positions are there.
void KeepJoints(const std::vector<int>& position, const std::vector<int>& torque,
                const std::string& place, const RobotTree& tree, JointColumns& result) {
  std::map<int, int> joint_of_column;
  for (std::size_t k = 0; k < position.size(); ++k) {
    if (position[k] >= 0) {
      joint_of_column[position[k]] = static_cast<int>(k);
    } else if (torque[k] >= 0) {
      throw InputError(place + "the column " + Quote(result.names[torque[k]]) +
                       " has torques of joint " + Quote(tree.joints[k].name) +
                       ", whose positions are missing");
    }
  }
  for (const auto& [column, joint] : joint_of_column) {
    result.joints.push_back(joint);
    result.positions.push_back(column);
    result.torques.push_back(torque[joint]);
  }
}

/// Keeps the force-torque sensors that have columns: all six.
void KeepWrenches(const std::vector<int>& wrench, const std::string& place, const Project& project,
                  JointColumns& result) {
  for (std::size_t i = 0; i < project.force_torque_sensors.size(); ++i) {
    std::array<int, 6> columns{};
    int missing = 0;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      columns[c] = wrench[columns.size() * i + c];
      missing += columns[c] < 0 ? 1 : 0;
    }
    if (missing == 6) continue;
    const std::string& name = project.force_torque_sensors[i].name;
    if (missing > 0) {
      throw InputError(place + "force-torque sensor " + Quote(name) +
                       " has only some of its columns; expected " + name + "_fx, " + name +
                       "_fy, " + name + "_fz, " + name + "_tx, " + name + "_ty, " + name + "_tz");
    }
    result.wrench_sensors.push_back(static_cast<int>(i));
    result.wrenches.push_back(columns);
  }
}

}  // namespace

JointColumns FindJointColumns(const std::vector<std::string>& header, const std::string& place,
                              const Project& project) {
  const Roles roles = FindRoles(project);
  JointColumns result;
  result.names = header;
  std::vector<int> position(project.tree.joints.size(), -1), torque = position;
  std::vector<int> wrench(kComponents.size() * project.force_torque_sensors.size(), -1);
  for (std::size_t i = 0; i < header.size(); ++i) {
    const auto role = roles.find(header[i]);
    if (role == roles.end() && header[i].ends_with("_velocity")) continue;
    if (role == roles.end()) FailUnknownColumn(header[i], place, KeysOf(roles), project.file);
    const auto& [kind, index] = role->second;
    if (kind == Role::Kind::kIgnored) continue;
    int& column = kind == Role::Kind::kTime       ? result.time
                  : kind == Role::Kind::kPosition ? position[index]
                  : kind == Role::Kind::kTorque   ? torque[index]
                                                  : wrench[index];
    if (column >= 0) {
      throw InputError(place + "the columns " + Quote(header[column]) + " and " + Quote(header[i]) +
                       " stand for the same");
    }
    column = static_cast<int>(i);
  }
  if (result.time < 0) {
    throw InputError(place + "there is no column of the time in s; expected " +
                     Quote(project.recording.time) + " or 'time'");
  }
  KeepJoints(position, torque, place, project.tree, result);
  KeepWrenches(wrench, place, project, result);
  if (result.joints.empty()) {
    throw InputError(place + "there is no column of any joint; expected the names of the joints");
  }
  return result;
}

}  // namespace elastocal
