// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/observation/observed_robot.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// Observations that were read, with the setup of the project in which all feet are placed.
struct ObservationTables {
  Observations observations;
  ObservationSetup setup;             ///< the project's, with all feet placed
  std::vector<std::string> warnings;  ///< joints beyond limits, repeated rows, ...
};

/// The files to read for a list of files and folders. A folder that `simulate` wrote stands for its
/// observations.csv and, if it exists, corners.csv. Throws InputError for other folders.
std::vector<std::filesystem::path> ObservationFiles(
    const std::vector<std::filesystem::path>& recordings);

/// Reads tables of observations (see ObservationFiles): CSV with a header row, one row for each
/// posture, and these columns:
/// - joints, under the names of the project, in rad or m;
/// - instruments, each in any of the tables; empty cells mean that it shows nothing in this
///   posture;
/// - the columns that tell sessions and plates.
/// A row in which no instrument shows anything is a touch of the plate that lies flattest, unless
/// the project names a column for the plate. `feet`, if given, says where the feet stand (from an
/// earlier calibration).
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
