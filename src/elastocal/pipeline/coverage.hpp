// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/calibration/outliers.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/recorded/measurements.hpp"
#include "elastocal/validation/verdict.hpp"

namespace elastocal {

/// What the recordings contain of a chain of the project.
struct ChainCoverage {
  std::string chain;
  /// Markers on the chain were seen in trials that are used for the estimate and that exercise it,
  /// or that exercise all of its joints with other chains. If false, its joints stay as in the
  /// URDF, except those that it shares with other chains or on which the robot stands.
  bool calibrated = false;
  /// Markers on the chain were seen in trials for validation, and could be predicted.
  bool judged = false;
  /// Trials for its calibration that cannot be used, with the reason.
  std::vector<std::string> refused;
  /// a trial for validation that is said to exercise it; empty: none
  std::string validation_trial;
  /// The trial for calibration that moves its joints most although it is not said to exercise the
  /// chain.
  std::string moving_trial;
  /// Joints that markers of the project show but no seen marker shows: they stay nominal.
  std::vector<std::string> unseen;
  /// Joints of a calibrated and judged chain that seen markers of the estimate show, but none that
  /// was predicted in the trials for validation that exercise them.
  std::vector<std::string> unjudged;
};

/// Coverage of the chains that carry markers, in the project's order. `predicted` says which
/// observations of the trials for validation the calibrated robot predicts; null: all.
std::vector<ChainCoverage> FindCoverage(const Project& project, const Measurements& measured,
                                        const ObservationMask* predicted = nullptr);

/// Objections, one for each link on which the robot stands alone in a trial for calibration that
/// cannot be used, or in a trial for validation, but in no trial that is used for the estimate. The
/// springs of that leg's ankle then stay at the prior, even if other trials calibrate its chain.
/// Empty where legs are rigid. An earlier calibration that knows these springs does not help, since
/// the model has no legs on which no trial of the estimate stands.
std::vector<std::string> UnknownStance(const Project& project, const Measurements& measured);

/// The trials for validation without those that stand on a link of UnknownStance alone. The robot
/// that was estimated says nothing of these, so that they contradict nothing.
Recording WithKnownStance(const Project& project, const Measurements& measured);

/// Adds an objection for each chain that stays uncalibrated because its trials cannot be used (a
/// user who records a chain expects its calibration), and for each chain that only trials for
/// validation exercise (`chains` of a trial is probably wrong). Adds a remark for each calibrated
/// chain that is not judged although there are trials for validation, or that has joints of which
/// no marker was seen, in the estimate or in those trials.
void JudgeCoverage(const std::vector<ChainCoverage>& coverage, Verdict& verdict);

/// What was calibrated and no held-out data judge: "chain head", or names of joints. Empty without
/// trials for validation.
std::vector<std::string> NotJudged(const std::vector<ChainCoverage>& coverage);

}  // namespace elastocal
