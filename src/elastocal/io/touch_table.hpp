#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/contact/contact_model.hpp"
#include "elastocal/io/project.hpp"

namespace elastocal {

/// Touches that were read, and the robot as it stands in them.
struct TouchTables {
  Touches touches;
  ContactSetup setup;                 ///< of the project, all feet placed
  std::vector<std::string> warnings;  ///< joints beyond their limits, a sentence each
};

/// Reads tables of touches: CSV with a header row, one row a touch, joint columns under the names
/// of the project in rad or m, and the columns that sessions and plates are told by. `feet`, where
/// given, says where the feet stand (from an earlier calibration).
///
/// Throws InputError naming file, line and column: what a Table refuses; a joint that moves a foot
/// or plate and has neither a column nor a position in the project; an unknown column; degrees for
/// radians; rows that are all the same; a plate of no known name; no plate that lies flat
/// (FindTouchingPlates); a column of sessions that is absent.
TouchTables ReadTouchTables(const std::vector<std::filesystem::path>& files, const Project& project,
                            const std::vector<ContactFoot>* feet = nullptr);

}  // namespace elastocal
