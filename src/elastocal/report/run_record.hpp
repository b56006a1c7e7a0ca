// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace elastocal {

/// A file that a command read.
struct InputRecord {
  std::string file;  ///< as given by the user, or as another input names it
  std::uintmax_t bytes = 0;
  std::string sha256;
};

/// Assumptions that a calibration was given beside its inputs.
struct Assumptions {
  std::vector<std::string> accept = {};  ///< mistakes that were corrected
  std::string prior = {};                ///< path of an earlier calibration; empty: none
  double days = 1.0;                     ///< age of the earlier calibration
  std::string marker_places = {};        ///< table of measured marker positions; empty: none
};

/// How a result was made: enough to repeat it.
struct RunRecord {
  std::string command;                ///< "calibrate"
  std::string command_line;           ///< as it would be typed
  std::string version;                ///< version of the program
  std::optional<std::uint64_t> seed;  ///< none: that of the project, or the default
  std::vector<InputRecord> inputs;
  std::string folder = {};                      ///< working directory, where relative names start
  std::optional<Assumptions> assumptions = {};  ///< for `calibrate`
};

/// Size and checksum of files, in the given order. Files that cannot be read, or are larger than 4
/// GiB, are left out.
std::vector<InputRecord> RecordInputs(const std::vector<std::filesystem::path>& files);

/// Quotes words so that a shell reads them back.
std::string QuoteCommandLine(const std::vector<std::string>& words);

/// runs.json with the record of this command, which replaces an earlier one, and those of other
/// commands from `runs` (the present text of the file; empty, or not of this kind: none).
std::string UpdateRuns(const std::string& runs, const RunRecord& record);

}  // namespace elastocal
