// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/observation/observation_figures.hpp"
#include "elastocal/pipeline/check_calibration.hpp"

namespace elastocal {

/// A few touches, or observations by other instruments, and whether a calibration still explains
/// them.
struct ContactCheck {
  std::string calibration_file, recording;
  Observations observations;
  ObservedRobot model;
  /// Tables, trackers and mountings fitted, the robot nominal, as calibrated, and with every joint
  /// free to have moved.
  ObservationFigures uncalibrated, calibrated, updated;
  std::vector<double> left_before;  ///< by row of the figures: noise that the calibration left, SI
  JointCheck check;
  bool converged = false;
  std::vector<std::string> mistakes;  ///< in the tables, which say nothing of the robot
  /// Faults of the tables without each of which the calibration holds: they explain it as well as
  /// joints that have moved.
  std::vector<std::string> alternatives;
  /// Whether single postures are the first of them: they are likelier to be wrong than joints to
  /// have moved.
  bool few_postures = false;
  std::vector<std::string> warnings;  ///< what is left out among them

  /// Rows of the figures that leave more than four times what the calibration left, and more than a
  /// fiftieth of what robots leave at most (LargestError).
  std::vector<std::string> FarRows(const ObservationFigures& figures) const;
  bool explained() const { return FarRows(updated).empty(); }
  /// Whether an alternative explains what otherwise takes several joints, or none does, or what a
  /// single posture alone shows.
  bool recording_explains() const;
  /// Whether the robot as calibrated leaves too much, and no joint is accused of it.
  bool changed_beyond_telling() const { return !check.changed() && !FarRows(calibrated).empty(); }
  bool unchanged() const;
};

/// Tells whether a stored calibration still explains a robot that touches tables or is measured by
/// instruments (FindMovedJoints), from far fewer postures than it takes to calibrate. Tables,
/// trackers and what is mounted on the robot may have been set up anew; feet stand where they did.
///
/// Throws InputError: files that cannot be read; a calibration of another robot, without covariance
/// or not made from such tables; fewer than four postures.
ContactCheck CheckContacts(const Project& project, const std::filesystem::path& calibration,
                           const std::vector<std::filesystem::path>& recordings,
                           const CheckOptions& options = {});

/// "unchanged", "moved", "changed" (no single joint can be named), "recording wrong"
/// (`mistakes`, or `alternatives` where these explain it and no single joint does), "unexplained"
/// (moved joints do not explain it) or "not converged".
std::string CheckStatus(const ContactCheck& run);

/// The figures for programs (docs/formats.md).
std::string MakeCheckJson(const ContactCheck& run);

}  // namespace elastocal
