// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/recording_columns.hpp"

#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {

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

void AddRole(const Project& project, const std::string& column, int quantity, ColumnRoles& roles) {
  if (roles.emplace(column, quantity).second) return;
  throw InputError(project.file.string() + ": the column " + Quote(column) +
                   " stands for two things; name one of them otherwise in recording.columns");
}

std::vector<int> FindRecordingColumns(const Table& table, ColumnRoles roles, std::size_t quantities,
                                      const Project& project) {
  for (const std::string& column : project.recording.ignore) roles[column] = kPassedOver;
  return FindColumns(
      table, roles, quantities,
      "columns that are not to be read are listed in recording.ignore of " + project.file.string() +
          ", those with other names than joints and markers have in recording.columns");
}

}  // namespace elastocal
