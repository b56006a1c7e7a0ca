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
  /// Errors after tables, trackers and mountings were fitted: of the nominal robot, of the robot as
  /// calibrated, and of one whose joints may all have moved.
  ObservationFigures uncalibrated, calibrated, updated;
  std::vector<double> left_before;  ///< by row of the figures: noise that the calibration left, SI
  JointCheck check;
  bool converged = false;
  std::vector<std::string> mistakes;  ///< in the tables, which say nothing of the robot
  /// Faults of the tables, each of which explains the misfit as well as moved joints do: once it is
  /// corrected, the calibration holds.
  std::vector<std::string> alternatives;
  /// Whether the first of these are single bad postures, which are more likely than moved joints.
  bool few_postures = false;
  std::vector<std::string> warnings;  ///< what is left out among them

  /// Rows of the figures with errors of more than four times what the calibration left, and of more
  /// than a fiftieth of the largest that a robot has (LargestError).
  std::vector<std::string> FarRows(const ObservationFigures& figures) const;
  bool explained() const { return FarRows(updated).empty(); }
  /// Whether the recording is to blame: an alternative explains the misfit, which moved joints do
  /// not, or only several of them, or which a single posture alone shows.
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
