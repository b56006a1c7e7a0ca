// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/project/project.hpp"
#include "elastocal/recorded/measurements.hpp"
#include "elastocal/validation/verdict.hpp"

namespace elastocal {

/// What the recordings say about a chain of the project.
struct ChainCoverage {
  std::string chain;
  /// Whether the chain is calibrated: markers on it were seen in trials that are estimated from and
  /// that exercise it, or that exercise all of its joints with other chains. If not, its joints
  /// stay as the URDF has them, except those that it shares with other chains or stands on.
  bool calibrated = false;
  bool judged = false;               ///< whether markers on it were seen in trials for validation
  std::vector<std::string> refused;  ///< trials for calibration of it that cannot be used, and why
  std::string validation_trial;      ///< one that is said to exercise it; empty: none
  /// The trial for calibration that moves its joints most without being said to exercise it.
  std::string moving_trial;
  /// Joints that markers of the project show, none of which was seen: they stay nominal.
  std::vector<std::string> unseen;
};

/// Of the chains that carry markers, in the project's order.
std::vector<ChainCoverage> FindCoverage(const Project& project, const Measurements& measured);

/// Objections: one for each link on which the robot stands alone in a trial for calibration that
/// cannot be used, or in a trial for validation, but in no trial that is estimated from. The
/// springs of that leg's ankle then stay those of the prior, even if other trials calibrate its
/// chain. None where legs are rigid.
std::vector<std::string> UnknownStance(const Project& project, const Measurements& measured);

/// Adds an objection for each chain that stays uncalibrated because its trials cannot be used
/// (whoever records a chain expects it to be calibrated), and for each chain that only trials for
/// validation exercise (`chains` of a trial is probably wrong). Adds a remark for each calibrated
/// chain that is not judged although others are, or that has joints of which nothing was seen.
void JudgeCoverage(const std::vector<ChainCoverage>& coverage, Verdict& verdict);

}  // namespace elastocal
