// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "elastocal/observation/observation_fit.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// The section `contact` of calibration.yaml (docs/formats.md): where the feet stand, quantities
/// other than those of the robot (tilts of plates, planes of tables, mountings, trackers), standard
/// deviations of all sources; then these quantities and standard deviations for the uncalibrated
/// robot.
std::string MakeContactYaml(const ObservedRobot& model, const ObservationFit& calibrated,
                            const ObservationFit& uncalibrated);

/// Quantities by name, and the standard deviations of the sources of the project's setup.
struct StoredContact {
  std::map<std::string, QuantityValue> quantities;
  Spread spread;
};

struct StoredContacts {
  std::vector<ContactFoot> feet;
  StoredContact calibrated, uncalibrated;
};

/// Whether a calibration.yaml has the section.
bool HasContacts(const std::filesystem::path& file);

/// Reads the section. Throws InputError naming file, line and key: a calibration that was not made
/// from touches or instruments, other feet or quantities than the project's.
StoredContacts ReadContacts(const std::filesystem::path& file, const Project& project);

}  // namespace elastocal
