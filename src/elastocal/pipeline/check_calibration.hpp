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

/// A few postures, and whether a calibration still explains them.
struct CheckRun {
  std::string calibration_file;
  Recording recording;
  TransferValidation transfer;  ///< waist and markers fitted, the joints as calibrated
  CalibrationResult estimate;   ///< the calibration as the prior, every joint free to have moved
  double rmse_estimate = 0.0;   ///< of `estimate` on the recording, outliers included, m
  JointCheck check;
  std::vector<std::string> mistakes;  ///< of the recording, which say nothing of the robot
  /// What explains it as well as joints that have moved (FindAlternatives).
  std::vector<std::string> alternatives;
  double expected_error = 0.0;  ///< of a robot that was never calibrated (ExpectedError), m
  double left_before = 0.0;     ///< by the calibration, of its own markers, rms, m; 0: unknown
  Eigen::VectorXd left;         ///< by `estimate`, rms over the markers of each posture, m
  std::vector<std::string> warnings;

  bool converged() const { return estimate.termination == Termination::kConverged; }
  /// Whether the calibrated robot errs by less than twice what one that was never calibrated is
  /// expected to. Otherwise "nothing has moved" would only mean that no single joint explains it.
  bool plausible() const;
  /// The largest error that a robot with moved joints may leave: four times that of the
  /// calibration, m.
  double most_left() const;
  /// Whether the robot, with every joint free to have moved, leaves no more than that.
  bool explained() const { return !(rmse_estimate > most_left()); }
  /// Whether the recording is to blame: an alternative explains the misfit, which moved joints do
  /// not, or only several of them.
  bool recording_explains() const;
  /// Whether the robot as calibrated leaves more than `most_left` and no joint is accused of it:
  /// the postures, or the markers, are too few to tell which joint it is.
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
