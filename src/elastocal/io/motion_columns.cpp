#include "elastocal/io/motion_columns.hpp"

#include <algorithm>
#include <string_view>

#include "elastocal/io/posture_columns.hpp"
#include "elastocal/io/text.hpp"
#include "elastocal/io/unknown_column.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/simulation/legs.hpp"

namespace elastocal {
namespace {

/// What a column name stands for.
struct Role {
  enum class Kind { kTime, kCoordinate, kSupport, kIgnored } kind = Kind::kIgnored;
  int index = 0;  ///< of the coordinate
};
using Roles = std::map<std::string, Role>;

Roles FindRoles(const Project& project, bool timed) {
  const Role::Kind time = timed ? Role::Kind::kTime : Role::Kind::kIgnored;
  Roles roles;
  for (const Joint& joint : project.tree.joints) {
    const Role role{joint.mimic ? Role::Kind::kIgnored : Role::Kind::kCoordinate, joint.coordinate};
    roles[joint.name] = role;
    roles[JointColumn(project, joint.name)] = role;
  }
  roles.emplace("support", Role{Role::Kind::kSupport});
  for (const std::string& name : {std::string("time"), project.recording.time}) {
    roles.emplace(name, Role{time});
  }
  for (const char* name : {"zmp_x", "zmp_y"}) roles.emplace(name, Role{});
  for (const Joint& joint : project.tree.joints) roles.emplace("torque_" + joint.name, Role{});
  for (const Marker& marker : project.markers) {
    if (timed) break;
    for (const std::string& column : MarkerColumns(project, marker.name)) {
      roles.emplace(column, Role{});
    }
  }
  for (const std::string& column : project.recording.ignore) roles[column] = Role{};
  return roles;
}

}  // namespace

MotionColumns FindMotionColumns(const std::vector<std::string>& header, const std::string& place,
                                const Project& project, bool timed) {
  const Roles roles = FindRoles(project, timed);
  MotionColumns columns{header, -1, -1, std::vector<int>(project.tree.coordinate_count(), -1)};
  const auto take = [&](int& entry, int column) {
    if (entry >= 0) {
      throw InputError(place + "columns " + Quote(header[entry]) + " and " + Quote(header[column]) +
                       " say the same");
    }
    entry = column;
  };
  for (std::size_t i = 0; i < header.size(); ++i) {
    const auto column = static_cast<int>(i);
    const auto role = roles.find(header[i]);
    if (role == roles.end()) FailUnknownColumn(header[i], place, KeysOf(roles), project.file);
    if (role->second.kind == Role::Kind::kTime) take(columns.time, column);
    if (role->second.kind == Role::Kind::kSupport) take(columns.support, column);
    if (role->second.kind == Role::Kind::kCoordinate) {
      take(columns.coordinates[role->second.index], column);
    }
  }
  if (timed && columns.time < 0) throw InputError(place + "there is no column 'time'");
  if (std::all_of(columns.coordinates.begin(), columns.coordinates.end(),
                  [](int column) { return column < 0; })) {
    throw InputError(place + "there is no column of any joint of robot " +
                     Quote(project.tree.name));
  }
  return columns;
}

SupportNames::SupportNames(const Project& project) {
  std::vector<NamedChain> chains;
  for (const Chain& chain : project.chains) {
    chains.push_back({chain.name, chain.from_link, chain.tip_link});
    links_[project.tree.links[chain.tip_link].name] = {chain.tip_link};
  }
  const std::vector<Leg> legs = FindLegs(project.tree, chains);
  if (legs.size() == 2) links_["both"] = {legs[0].foot_link, legs[1].foot_link};
  links_["none"] = {};
}

std::vector<int> SupportNames::Find(const std::string& cell, const std::string& place) const {
  std::vector<int> support;
  for (std::size_t begin = 0; begin <= cell.size();) {
    const std::size_t end = std::min(cell.find('+', begin), cell.size());
    const std::string name(Trim(std::string_view(cell).substr(begin, end - begin)));
    const auto found = links_.find(name);
    if (found == links_.end()) {
      std::vector<std::string> known;
      for (const auto& [text, links] : links_) known.push_back(text);
      throw InputError(place + "column 'support': found " + Quote(name) +
                       "; expected 'both', 'none' or the tip of a chain" +
                       DidYouMean(name.substr(0, 60), known));
    }
    for (int link : found->second) {
      if (std::find(support.begin(), support.end(), link) != support.end()) {
        throw InputError(place + "column 'support': " + Quote(cell) + " names a link twice");
      }
      support.push_back(link);
    }
    begin = end + 1;
  }
  return support;
}

}  // namespace elastocal
