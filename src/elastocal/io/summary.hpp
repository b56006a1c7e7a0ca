#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/calibration/knocks.hpp"
#include "elastocal/identifiability/observability.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/measurement/trial_summary.hpp"
#include "elastocal/validation/held_out.hpp"
#include "elastocal/validation/model_comparison.hpp"
#include "elastocal/validation/verdict.hpp"

namespace elastocal {

/// All that a calibration run has to say.
struct CalibrationRun {
  Recording recording;
  BaseParameters base;
  Excitation excitation;
  ModelComparison comparison;
  CrossValidation cross_validation;  ///< folds 0: not asked for
  std::vector<TrialSummary> trials;  ///< of recording folders
  std::vector<Knock> knocks;         ///< whose clusters are taken as two
  std::optional<HeldOut> held_out;   ///< where trials for validation were recorded
  ByModel<double> waist_error = {};  ///< m, see WaistError; NaN where the truth is unknown
  Verdict verdict;
  std::vector<std::string> warnings;
};

/// "converged", "not converged", "failed", or "implausible" where the verdict has objections though
/// the fit has converged.
std::string RunStatus(const CalibrationRun& run);

/// summary.json: the figures of a run, for programs to read (docs/formats.md).
std::string MakeSummaryJson(const CalibrationRun& run);

/// A posture as people find it again: "posture 12", or "trial leg_left, posture 3".
std::string DescribePosture(const Recording& recording, int posture);

/// The marker seen in a posture as people find it again: "posture 12 (line 14), marker LHAND_1".
std::string DescribeObservation(const Recording& recording, int posture, int marker);

}  // namespace elastocal
