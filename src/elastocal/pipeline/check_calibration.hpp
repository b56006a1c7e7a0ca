// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/validation/moved_joints.hpp"
#include "elastocal/validation/transfer.hpp"

namespace elastocal {

/// Result of a check: a few postures, and whether a calibration still explains them.
struct CheckRun {
  std::string calibration_file;
  Recording recording;
  TransferValidation transfer;  ///< fit of waist and markers with the joints as calibrated
  /// Fit with the calibration as prior and every joint free to have moved.
  CalibrationResult estimate;
  double rmse_estimate = 0.0;  ///< error of `estimate` on the recording, outliers included, m
  JointCheck check;
  /// Mistakes of the recording, which tell nothing about the robot.
  std::vector<std::string> mistakes;
  /// What explains the recording as well as moved joints do (FindAlternatives).
  std::vector<std::string> alternatives;
  /// Expected error of a robot that was never calibrated (ExpectedError), m.
  double expected_error = 0.0;
  /// Error that the calibration left on its own markers, rms, m; 0: unknown.
  double left_before = 0.0;
  Eigen::VectorXd left;  ///< error that `estimate` leaves, rms over the markers of each posture, m
  std::vector<std::string> warnings;

  bool converged() const { return estimate.termination == Termination::kConverged; }
  /// Whether the error of the calibrated robot is less than twice that expected of a robot that was
  /// never calibrated. Otherwise "nothing has moved" would only mean that no single joint explains
  /// the error.
  bool plausible() const;
  /// The largest error that a robot with moved joints may leave, m: four times that of the
  /// calibration, at least 2 % of `expected_error`; infinite where `left_before` is unknown.
  double most_left() const;
  /// Whether `estimate` leaves at most `most_left`.
  bool explained() const { return !(rmse_estimate > most_left()); }
  /// Whether the recording is to blame: an alternative explains the misfit, and moved joints do
  /// not, or only several of them.
  bool recording_explains() const;
  /// Whether the calibrated robot leaves more than `most_left` although no joint is accused: the
  /// postures or the markers are too few to tell which joint it is.
  bool changed_beyond_telling() const;
  /// Whether the calibration still explains the robot.
  bool unchanged() const;
};

struct CheckOptions {
  JointCheckOptions joints = {};
  double days = 1.0;                       ///< since the calibration
  std::optional<std::uint64_t> seed = {};  ///< instead of the project's
  std::vector<std::string> accept = {};    ///< mistakes of the recording, see AcceptMistakes
};

/// Tells whether a stored calibration still explains a robot, from far fewer postures than it takes
/// to calibrate (FindMovedJoints). Markers and cameras may have been set up anew; markers that
/// stayed are found (FindMarkersThatStayed).
///
/// `calibration`: the folder that calibrate wrote to, or its calibration.yaml, with its covariance.
/// `recording`: a posture table or a recording folder. Throws InputError: files that cannot be
/// read; a calibration of a robot with other nominal geometry than the project's, or without
/// covariance; fewer equations than the waist and the markers have unknowns.
CheckRun CheckCalibration(const Project& given, const std::filesystem::path& calibration,
                          const std::filesystem::path& recording, const CheckOptions& options = {});

/// "unchanged", "moved", "changed" (no single joint can be named), "recording wrong" (`mistakes`,
/// or `alternatives` where these explain it and no single joint does), "unexplained" (moved joints
/// do not explain it), "implausible" or "not converged".
std::string CheckStatus(const CheckRun& run);

/// The figures for programs (docs/formats.md).
std::string MakeCheckJson(const CheckRun& run);

}  // namespace elastocal
