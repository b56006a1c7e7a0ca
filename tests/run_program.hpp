// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace elastocal {

/// What a run of the program printed, and its exit code.
struct ProgramResult {
  int exit_code = -1;
  std::string out, err;
};

/// The built `elastocal`.
std::string ProgramFile();

/// A file that the build generates: the manual page, or the completions of shells.
std::filesystem::path GeneratedFile(const std::string& name);

/// Runs the built `elastocal` with these arguments, as a shell would.
ProgramResult RunProgram(const std::string& arguments);

}  // namespace elastocal
