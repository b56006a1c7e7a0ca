// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/observation/observation_figures.hpp"
#include "elastocal/pipeline/check_calibration.hpp"

namespace elastocal {

/// Result of a check by touches, or by observations of other instruments: whether a calibration
/// still explains them.
struct ContactCheck {
  std::string calibration_file, recording;
  Observations observations;
  ObservedRobot model;
  /// Errors after tables, trackers and mountings were fitted: of the nominal robot, of the
  /// calibrated robot, and of a robot all of whose joints may have moved.
  ObservationFigures uncalibrated, calibrated, updated;
  std::vector<double> left_before;  ///< by row of the figures: noise that the calibration left, SI
  JointCheck check;
  bool converged = false;
  /// Mistakes in the tables, which tell nothing about the robot.
  std::vector<std::string> mistakes;
  /// Faults of the tables, each of which explains the misfit as well as moved joints do: with it
  /// corrected, the calibration holds.
  std::vector<std::string> alternatives;
  /// The first of these are single bad postures, which are more probable than moved joints.
  bool few_postures = false;
  std::vector<std::string> warnings;  ///< warnings, among them observations that are left out

  /// Names of the rows in `figures` whose error exceeds four times what the calibration left and
  /// one fiftieth of the largest error that a robot has (LargestError).
  std::vector<std::string> FarRows(const ObservationFigures& figures) const;
  bool explained() const { return FarRows(updated).empty(); }
  /// Whether the recording is to blame: an alternative explains the misfit, and moved joints do
  /// not, or only several of them, or the joint is accused by a single posture alone.
  bool recording_explains() const;
  /// Whether the calibrated robot leaves too large errors although no joint is accused.
  bool changed_beyond_telling() const { return !check.changed() && !FarRows(calibrated).empty(); }
  bool unchanged() const;
};

/// Finds out whether a stored calibration still explains a robot that touches tables or is measured
/// by instruments (FindMovedJoints), from far fewer postures than a calibration needs. Tables,
/// trackers and what is mounted on the robot may have been set up anew; feet stand where they
/// stood.
///
/// Throws InputError for files that cannot be read, for a calibration of another robot, without
/// covariance or not made from such tables, and for fewer than four postures.
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
