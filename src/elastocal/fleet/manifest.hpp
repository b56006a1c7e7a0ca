// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace elastocal {

/// One session of one robot: commands of the program that are run one after the other, and the
/// folder for their results.
struct FleetTask {
  std::string name;                ///< name of its folder; [A-Za-z0-9_.-]+
  std::string robot;               ///< the same for all sessions of a robot
  std::string batch;               ///< maker's batch; may be empty
  std::optional<double> day = {};  ///< time of the recording, days; for drift
  std::filesystem::path project;
  std::vector<std::filesystem::path> recordings;  ///< empty: the robot is virtual
  std::vector<std::vector<std::string>> commands;
  /// Files that the commands leave and that are not kept.
  std::vector<std::filesystem::path> leftovers;
};

/// Reads a manifest (docs/formats.md, Fleets): recorded sessions, and studies of virtual robots
/// (design x seed x setting). `output` is the folder for all results, with a folder for each task.
/// Relative paths start in the manifest's folder. Throws InputError that names file, line and key
/// for malformed YAML, an unknown key, two tasks with one name, a session without recording, and an
/// empty list of tasks.
std::vector<FleetTask> ReadManifest(const std::filesystem::path& file,
                                    const std::filesystem::path& output);

}  // namespace elastocal
