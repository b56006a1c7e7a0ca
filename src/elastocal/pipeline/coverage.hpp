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
  /// Whether markers on the chain were seen in what is estimated from, in trials that exercise it
  /// or all its joints as those of other chains. If not, its joints stay as the URDF has them, but
  /// for those that it shares with other chains or stands on.
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

/// Objections where trials for calibration cannot be used: links on which the robot stands alone in
/// one of these or in a trial for validation, and in no trial that is estimated from. The springs
/// of that leg's ankle are those of the prior then, even where its chain is calibrated from others.
/// Nothing where legs are rigid.
std::vector<std::string> UnknownStance(const Project& project, const Measurements& measured);

/// Adds an objection for each chain that stays uncalibrated because its trials cannot be used: who
/// records a chain expects it to be calibrated. Another for each chain that trials for validation
/// exercise and no trial for calibration: more likely, `chains` of a trial is wrong. And a remark
/// for each that was calibrated and is not judged although others are, or of which joints were not
/// seen.
void JudgeCoverage(const std::vector<ChainCoverage>& coverage, Verdict& verdict);

}  // namespace elastocal
