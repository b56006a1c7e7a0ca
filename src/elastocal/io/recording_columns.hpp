// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "elastocal/project/project.hpp"
#include "elastocal/tables/table_reader.hpp"

namespace elastocal {

/// The column of a joint: as the project has it, or the joint's name.
std::string JointColumn(const Project& project, const std::string& joint);

/// The columns of a marker: as the project has them, or the default ones.
std::array<std::string, 3> MarkerColumns(const Project& project, const std::string& marker);

/// Default columns of a marker: NAME_x, NAME_y, NAME_z.
std::array<std::string, 3> DefaultMarkerColumns(const std::string& marker);

/// Adds the role of a column that the project names. Throws InputError, naming the project file, if
/// the column has a role already.
void AddRole(const Project& project, const std::string& column, int quantity, ColumnRoles& roles);

/// FindColumns, which also passes over the columns that the project ignores.
std::vector<int> FindRecordingColumns(const Table& table, ColumnRoles roles, std::size_t quantities,
                                      const Project& project);

}  // namespace elastocal
