// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/observation/observed_robot.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// Observations that were read, and the robot as it stands in them.
struct ObservationTables {
  Observations observations;
  ObservationSetup setup;             ///< of the project, all feet placed
  std::vector<std::string> warnings;  ///< joints beyond limits, repeated rows, ..., a sentence each
};

/// The files to read where folders may be named: a folder that `simulate` wrote stands for its
/// observations.csv, with corners.csv where there is one. Throws InputError for another folder.
std::vector<std::filesystem::path> ObservationFiles(
    const std::vector<std::filesystem::path>& recordings);

/// Reads tables of observations (of ObservationFiles): CSV with a header row, one row a posture;
/// joint columns under the names of the project in rad or m; the columns of instruments, each in
/// any of the tables, where empty cells mean that it shows nothing in this posture; the columns
/// that sessions and plates are told by. A row in which no instrument shows anything is a touch of
/// the plate that lies flattest, unless the project names a column that says it. `feet`, where
/// given, says where the feet stand (from an earlier calibration).
///
/// Throws InputError naming file, line and column: what a Table refuses; a joint that moves a foot
/// or what is observed and has neither a column nor a position in the project; an unknown column;
/// degrees for radians; rows that are all the same; what an instrument cannot show (ReadMeasured);
/// a plate of no known name; no plate that lies flat (FindTouchingPlates); a column of sessions
/// that is absent; nothing that was observed.
ObservationTables ReadObservationTables(const std::vector<std::filesystem::path>& recordings,
                                        const Project& project,
                                        const std::vector<ContactFoot>* feet = nullptr);

}  // namespace elastocal
