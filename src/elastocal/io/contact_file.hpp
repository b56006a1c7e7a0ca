#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/contact/contact_fit.hpp"
#include "elastocal/io/project.hpp"

namespace elastocal {

/// The section `contact` of calibration.yaml (docs/formats.md): where the feet stand, tilts of the
/// plates, planes of the tables, standard deviations of all sources; then plates and tables of the
/// uncalibrated robot.
std::string MakeContactYaml(const ContactModel& model, const ContactFit& calibrated,
                            const ContactFit& uncalibrated);

/// Plates and tables of a robot, and what varies.
struct StoredContact {
  std::vector<Eigen::Vector2d> plate_tilts;
  std::vector<TablePlane> tables;
  ContactSpread spread;
};

struct StoredContacts {
  std::vector<ContactFoot> feet;
  StoredContact calibrated, uncalibrated;
};

/// Reads the section. Throws InputError naming file, line and key: a calibration that was not made
/// from touches, other feet or plates than the project's.
StoredContacts ReadContacts(const std::filesystem::path& file, const Project& project);

}  // namespace elastocal
