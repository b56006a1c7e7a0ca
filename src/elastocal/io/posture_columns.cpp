#include "elastocal/io/posture_columns.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "elastocal/io/text.hpp"
#include "elastocal/io/unknown_column.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

/// What a column name stands for in this project.
struct Role {
  enum class Kind { kTime, kMarker, kCoordinate, kIgnored } kind = Kind::kIgnored;
  int index = 0;  ///< of the marker or coordinate
  int axis = 0;   ///< of the marker
};

using Roles = std::map<std::string, Role>;

const std::string& CoordinateName(const RobotTree& tree, int coordinate) {
  return tree.joints[tree.coordinate_joint[coordinate]].name;
}

Roles FindRoles(const Project& project) {
  Roles roles;
  const auto add = [&](const std::string& column, const Role& role) {
    if (!roles.emplace(column, role).second) {
      throw InputError(project.file.string() + ": the column " + Quote(column) +
                       " stands for two things; name one of them otherwise in recording.columns");
    }
  };
  add(project.recording.time, {Role::Kind::kTime});
  for (int i = 0; i < project.tree.coordinate_count(); ++i) {
    add(JointColumn(project, CoordinateName(project.tree, i)), {Role::Kind::kCoordinate, i});
  }
  for (std::size_t m = 0; m < project.markers.size(); ++m) {
    const std::array<std::string, 3> columns = MarkerColumns(project, project.markers[m].name);
    for (int axis = 0; axis < 3; ++axis) {
      add(columns[axis], {Role::Kind::kMarker, static_cast<int>(m), axis});
    }
  }
  // Joints that follow others need not be read.
  for (const Joint& joint : project.tree.joints) {
    if (joint.mimic) roles.emplace(joint.name, Role{});
  }
  for (const std::string& column : project.recording.ignore) roles[column] = Role{};
  return roles;
}

void KeepCompleteMarkers(const std::vector<std::array<int, 3>>& columns, const std::string& place,
                         const Project& project, PostureColumns& result) {
  for (std::size_t m = 0; m < columns.size(); ++m) {
    const std::array<int, 3>& xyz = columns[m];
    const auto missing = std::find(xyz.begin(), xyz.end(), -1);
    if (std::count(xyz.begin(), xyz.end(), -1) == 3) continue;
    const std::string& name = project.markers[m].name;
    if (missing != xyz.end()) {
      throw InputError(place + "the column " +
                       Quote(MarkerColumns(project, name)[missing - xyz.begin()]) + " of marker " +
                       Quote(name) + " is missing");
    }
    result.markers.push_back(static_cast<int>(m));
    result.marker_columns.push_back(xyz);
  }
  if (result.markers.empty()) {
    const std::string& first = project.markers[0].name;
    throw InputError(place + "there is no column of any marker; expected " +
                     Quote(MarkerColumns(project, first)[0]) + " of marker " + Quote(first) +
                     " or others");
  }
}

/// A joint that moves a recorded marker must have a position.
void CheckJoints(const std::string& place, const Project& project, const PostureColumns& columns) {
  const RobotTree& tree = project.tree;
  for (int m : columns.markers) {
    const Marker& marker = project.markers[m];
    for (int k : JointsToBody(tree, tree.links[marker.link].body)) {
      const int coordinate = tree.joints[k].coordinate;
      const std::string& name = CoordinateName(tree, coordinate);
      if (columns.coordinate_columns[coordinate] >= 0 ||
          project.recording.not_recorded.contains(name)) {
        continue;
      }
      const bool revolute =
          tree.joints[tree.coordinate_joint[coordinate]].type == JointType::kRevolute;
      throw InputError(place + "the column " + Quote(JointColumn(project, name)) + " of joint " +
                       Quote(name) + ", which moves marker " + Quote(marker.name) +
                       ", is missing; a joint that stood still is given in recording." +
                       (revolute ? "not_recorded_deg" : "not_recorded_mm") + " of " +
                       project.file.string());
    }
  }
}

}  // namespace

std::string JointColumn(const Project& project, const std::string& joint) {
  const auto renamed = project.recording.joints.find(joint);
  return renamed == project.recording.joints.end() ? joint : renamed->second;
}

std::array<std::string, 3> MarkerColumns(const Project& project, const std::string& marker) {
  const auto renamed = project.recording.markers.find(marker);
  return renamed == project.recording.markers.end() ? DefaultMarkerColumns(marker)
                                                    : renamed->second;
}

std::array<std::string, 3> DefaultMarkerColumns(const std::string& marker) {
  return {marker + "_x", marker + "_y", marker + "_z"};
}

PostureColumns FindPostureColumns(const std::vector<std::string>& header, const std::string& place,
                                  const Project& project) {
  const Roles roles = FindRoles(project);
  PostureColumns result;
  result.names = header;
  result.coordinate_columns.assign(project.tree.coordinate_count(), -1);
  std::vector<std::array<int, 3>> markers(project.markers.size(), {-1, -1, -1});
  std::set<std::string> seen;
  for (std::size_t i = 0; i < header.size(); ++i) {
    const int column = static_cast<int>(i);
    if (header[i].empty()) {
      throw InputError(place + "empty column name, cell " + std::to_string(i + 1));
    }
    const auto role = roles.find(header[i]);
    if (role == roles.end()) FailUnknownColumn(header[i], place, KeysOf(roles), project.file);
    const auto& [kind, index, axis] = role->second;
    if (kind == Role::Kind::kIgnored) continue;
    if (!seen.insert(header[i]).second) {
      throw InputError(place + "the column " + Quote(header[i]) + " comes twice");
    }
    if (kind == Role::Kind::kTime) result.time = column;
    if (kind == Role::Kind::kMarker) markers[index][axis] = column;
    if (kind == Role::Kind::kCoordinate) result.coordinate_columns[index] = column;
  }
  KeepCompleteMarkers(markers, place, project, result);
  CheckJoints(place, project, result);
  return result;
}

}  // namespace elastocal
