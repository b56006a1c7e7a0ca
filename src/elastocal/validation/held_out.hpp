// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/validation/error_table.hpp"
#include "elastocal/validation/model_comparison.hpp"

namespace elastocal {

/// Group of chains that each trial of a recording judges. Chains that share joints form one group,
/// whose name is the chains' names joined by "+" (section 6: head, arms and trunk are one group,
/// each leg is another). Empty for a trial without postures.
std::vector<std::string> TrialGroups(const ErrorModel& model, const Recording& recording);

/// Errors of the models of `comparison` on trials that were not used for the estimate (section
/// 6.1.4). Joints, elasticity and markers are as estimated; only the support foot of each trial is
/// placed anew. One entry for each trial with postures.
struct HeldOut {
  ByModel<Prediction> predictions;
  ErrorTable table;  ///< Table 2
};

HeldOut JudgeOnTrials(const ModelComparison& comparison, const Recording& recording,
                      const CalibrationOptions& options);

/// As JudgeOnTrials, but for the largest model only, which takes a fraction of the time.
HeldOut JudgeLargestOnTrials(const ModelComparison& comparison, const Recording& recording,
                             const CalibrationOptions& options);

/// Which observations a model predicts: those that are seen where the root link can be placed.
ObservationMask Predicted(const HeldOut& held_out, ModelKind kind);

/// Error of the waist in postures on one foot, m: root mean square distance between the true origin
/// of the root link and the one that the model predicts from the support foot. `predicted` must be
/// made with FootingBy::kFootMarkers. Where the model's frame lies in the waist is a convention, so
/// that its displacement from the true frame is subtracted first. That displacement is estimated
/// from postures that no footing ties, where the waist's own markers locate the waist, or without
/// these from the same postures. NaN for fewer than two postures.
double WaistError(const Placement& predicted, const std::vector<std::optional<Transform>>& truth);

}  // namespace elastocal
