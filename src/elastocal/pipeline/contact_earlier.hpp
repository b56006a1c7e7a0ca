// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/calibration/earlier.hpp"
#include "elastocal/io/calibration_file.hpp"
#include "elastocal/io/contact_file.hpp"
#include "elastocal/io/observation_table.hpp"
#include "elastocal/validation/moved_joints.hpp"

namespace elastocal {

/// The robot of a stored calibration as it stands in tables: elastic where that found it elastic,
/// and with its causes beyond springs, as far as tables show them (ObservableCorrections); what is
/// in common says nothing about values that are known. Throws InputError for a calibration
/// of another robot.
ObservedRobot MakeStoredRobot(const StoredCalibration& stored, const Project& project,
                              const ObservationSetup& setup);

/// An earlier calibration of a robot that touches tables or is measured by instruments.
struct EarlierContacts {
  StoredCalibration stored;
  StoredContacts contacts;
  CalibrationEstimate estimate;
  /// Whether it was made from touches or instruments; else it knows the robot alone, and contacts
  /// are as the project has them.
  bool of_contacts = true;
};

/// Reads the folder that calibrate wrote to, or its calibration.yaml. Throws InputError: files that
/// cannot be read, or without covariance; a calibration that was not made from such tables.
EarlierContacts ReadEarlierContacts(const std::filesystem::path& calibration,
                                    const Project& project);

/// The same of a prior, which may also have been made from markers, or be that of a fleet.
EarlierContacts ReadPriorOfContacts(const std::filesystem::path& calibration,
                                    const Project& project);

/// The robot as it stands in new tables, as MakeStoredRobot has it.
/// What it found to vary is the first guess, and counts as ten numbers. Throws InputError for a
/// calibration of another robot.
ObservedRobot MakeRobotAfterEarlier(const EarlierContacts& earlier, const Project& project,
                                    const ObservationTables& tables);

/// What the earlier calibration says of that robot `days` later (MakeEarlierEstimate).
EarlierEstimate MakeEarlierOfContacts(const EarlierContacts& earlier, const ObservedRobot& model,
                                      const Project& project, double days);

/// New observations fitted with the earlier calibration as the prior, every joint free to have
/// moved since, and the joints that have (FindMovedJoints).
struct OpenedRobot {
  ObservedRobot model;
  ObservedEstimate estimate;
  JointCheck check;
};
OpenedRobot OpenJoints(const ObservedRobot& model, const EarlierEstimate& earlier,
                       const Observations& observations, const Project& project,
                       const JointCheckOptions& options = {});

/// Makes the earlier calibration the prior of a robot. What it says of joints that seem to have
/// moved since counts as little as what is known of a new robot. Returns what a user should know of
/// it, a sentence each.
std::vector<std::string> StartFromEarlierContacts(const EarlierContacts& earlier,
                                                  const Observations& observations,
                                                  const Project& project, double days,
                                                  ObservedRobot& model);

}  // namespace elastocal
