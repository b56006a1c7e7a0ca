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

/// The robot of a stored calibration, for the given tables. It has the elasticity of the
/// calibration and those of its causes that tables show (ObservableCorrections). Parameters in
/// common say nothing about values that are known. Throws InputError for a calibration of another
/// robot.
ObservedRobot MakeStoredRobot(const StoredCalibration& stored, const Project& project,
                              const ObservationSetup& setup);

/// An earlier calibration of a robot that touches tables or is measured by instruments.
struct EarlierContacts {
  StoredCalibration stored;
  StoredContacts contacts;
  CalibrationEstimate estimate;
  /// It was made from touches or instruments. If false, it knows the robot alone, and contacts are
  /// as in the project.
  bool of_contacts = true;
};

/// Reads a calibration: the folder that calibrate wrote to, or its calibration.yaml. Throws
/// InputError for files that cannot be read, without covariance, and for a calibration that was not
/// made from such tables.
EarlierContacts ReadEarlierContacts(const std::filesystem::path& calibration,
                                    const Project& project);

/// As ReadEarlierContacts, for a prior, which may also be made from markers, or be that of a fleet.
EarlierContacts ReadPriorOfContacts(const std::filesystem::path& calibration,
                                    const Project& project);

/// The robot for new tables, as by MakeStoredRobot. The standard deviations that the calibration
/// found are the first guess and count as ten numbers each. Throws InputError for a calibration of
/// another robot.
ObservedRobot MakeRobotAfterEarlier(const EarlierContacts& earlier, const Project& project,
                                    const ObservationTables& tables);

/// What the earlier calibration tells about that robot `days` later (MakeEarlierEstimate).
EarlierEstimate MakeEarlierOfContacts(const EarlierContacts& earlier, const ObservedRobot& model,
                                      const Project& project, double days);

/// Fit of new observations with the earlier calibration as prior and every joint free to have moved
/// since, and the joints that have moved (FindMovedJoints).
struct OpenedRobot {
  ObservedRobot model;
  ObservedEstimate estimate;
  JointCheck check;
};
OpenedRobot OpenJoints(const ObservedRobot& model, const EarlierEstimate& earlier,
                       const Observations& observations, const Project& project,
                       const JointCheckOptions& options = {});

/// Makes the earlier calibration the prior of a robot. For joints that seem to have moved since,
/// the prior is as wide as for a new robot. Returns warnings for the user, a sentence each.
std::vector<std::string> StartFromEarlierContacts(const EarlierContacts& earlier,
                                                  const Observations& observations,
                                                  const Project& project, double days,
                                                  ObservedRobot& model);

}  // namespace elastocal
