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
  std::string file;  ///< as the user gave it, or as another input names it
  std::uintmax_t bytes = 0;
  std::string sha256;
};

/// What a calibration was told beside its inputs.
struct Assumptions {
  std::vector<std::string> accept = {};  ///< mistakes that were corrected
  std::string prior = {};                ///< an earlier calibration; empty: none
  double days = 1.0;                     ///< since then
  std::string marker_places = {};        ///< table of measured places of markers; empty: none
};

/// How a result came about: enough to get it again.
struct RunRecord {
  std::string command;                ///< "calibrate"
  std::string command_line;           ///< as it would be typed
  std::string version;                ///< of the program
  std::optional<std::uint64_t> seed;  ///< none: the project's, or the default
  std::vector<InputRecord> inputs;
  std::string folder = {};  ///< in which it was typed: relative names start there
  std::optional<Assumptions> assumptions = {};  ///< of `calibrate`
};

/// Size and checksum of files, in their order; those that cannot be read, or are larger than 4 GiB,
/// are left out.
std::vector<InputRecord> RecordInputs(const std::vector<std::filesystem::path>& files);

/// A command line that a shell reads as these words.
std::string QuoteCommandLine(const std::vector<std::string>& words);

/// runs.json with the record of this command, replacing an earlier one, and those of other commands
/// as they are in `runs` (the text of the file so far; empty, or not of this kind: none).
std::string UpdateRuns(const std::string& runs, const RunRecord& record);

}  // namespace elastocal
