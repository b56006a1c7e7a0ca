// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "elastocal/simulation/virtual_experiment.hpp"

namespace elastocal {

/// One option of the virtual experiment, as given on the command line (`--marker-noise-mm`) or in a
/// settings file (`marker_noise_mm`).
struct SimulationSetting {
  using Target = std::variant<double*, std::optional<double>*, int*, std::string*, Vector6d*>;

  std::string group, key;  ///< the key ends with its unit
  Target target;           ///< member of the options for which it was listed
  double unit = 1.0;       ///< the unit in SI
  double least = 0.0, most = 0.0;
  std::string help;
};

/// All options, bound to `options`: every imperfection, every fault, and what is played.
std::vector<SimulationSetting> SimulationSettings(VirtualExperimentOptions& options);

/// Present value as text, for --help; empty where there is none.
std::string SettingText(const SimulationSetting& setting);

/// Sets an option from text: numbers separated by blanks or commas, or a name. Throws InputError
/// with `place` for a text that is no number or out of range.
void ApplySetting(const SimulationSetting& setting, const std::string& text,
                  const std::string& place);

/// Throws InputError that names both keys where the lower end of a range is above the upper one.
void CheckRanges(const VirtualExperimentOptions& options);

/// Throws InputError that names both keys where a cause or fault has a size, but no joint, link,
/// marker or cluster to which it applies.
void CheckTargets(const VirtualExperimentOptions& options);

/// Reads a settings file: a YAML mapping of keys to values. Throws InputError that names file, line
/// and key, and for an unknown key the nearest known one.
void ReadSimulationSettings(const std::filesystem::path& file, VirtualExperimentOptions& options);

}  // namespace elastocal
