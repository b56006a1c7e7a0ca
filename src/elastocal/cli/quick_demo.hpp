// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "elastocal/cli/commands.hpp"

namespace elastocal::cli {

/// Options of QuickDemo.
struct QuickDemoOptions {
  CommonOptions common;
  std::filesystem::path project;  ///< path of the project of the embedded humanoid
  std::filesystem::path output;   ///< folder for the recording and the results
  int postures = 60;
};

/// Calibrates the upper body from a generated table of random postures, and prints true and
/// estimated values. Returns the exit code.
int QuickDemo(const QuickDemoOptions& options);

}  // namespace elastocal::cli
