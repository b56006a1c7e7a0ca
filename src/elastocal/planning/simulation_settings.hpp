// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "elastocal/simulation/virtual_experiment.hpp"

namespace elastocal {

/// One option of the virtual experiment as a user gives it, on the command line
/// (`--marker-noise-mm`) or in a settings file (`marker_noise_mm`).
struct SimulationSetting {
  using Target = std::variant<double*, std::optional<double>*, int*, std::string*, Vector6d*>;

  std::string group, key;  ///< the key carries its unit
  Target target;           ///< in the options that it was listed for
  double unit = 1.0;       ///< in SI
  double least = 0.0, most = 0.0;
  std::string help;
};

/// All options, referring to `options`: every imperfection, fault, and what is played.
std::vector<SimulationSetting> SimulationSettings(VirtualExperimentOptions& options);

/// Current value as text, for --help; empty where there is none.
std::string SettingText(const SimulationSetting& setting);

/// Sets an option from text: numbers separated by blanks or commas, or a name. Throws InputError
/// with `place` for what is no number or out of range.
void ApplySetting(const SimulationSetting& setting, const std::string& text,
                  const std::string& place);

/// Throws InputError naming both keys where the least of a range is above the largest.
void CheckRanges(const VirtualExperimentOptions& options);

/// Throws InputError naming both keys where a cause or fault has a size, and no joint, link, marker
/// or cluster to have it.
void CheckTargets(const VirtualExperimentOptions& options);

/// Reads a settings file: a YAML mapping of keys to values. Throws InputError naming file, line and
/// key, with the nearest known key for one that is unknown.
void ReadSimulationSettings(const std::filesystem::path& file, VirtualExperimentOptions& options);

}  // namespace elastocal
