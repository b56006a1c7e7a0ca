// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace elastocal {

/// One session of one robot: commands of the program, run one after the other, and the folder for
/// their results.
struct FleetTask {
  std::string name;                ///< of its folder; [A-Za-z0-9_.-]+
  std::string robot;               ///< sessions of one robot have the same
  std::string batch;               ///< of its maker; may be empty
  std::optional<double> day = {};  ///< when it was recorded, days; for drift
  std::filesystem::path project;
  std::vector<std::filesystem::path> recordings;  ///< none: the robot is virtual
  std::vector<std::vector<std::string>> commands;
  /// What the commands leave that is not kept.
  std::vector<std::filesystem::path> leftovers;
};

/// Reads a manifest (docs/formats.md, Fleets): sessions that were recorded, and studies of virtual
/// robots (design x seed x setting). `output`: the folder for all results, a folder a task in it.
/// Relative paths are seen from the manifest's folder. Throws InputError naming file, line and key:
/// malformed YAML, unknown key, two tasks of one name, a session without recording, nothing to do.
std::vector<FleetTask> ReadManifest(const std::filesystem::path& file,
                                    const std::filesystem::path& output);

}  // namespace elastocal
