// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/validation/error_table.hpp"
#include "elastocal/validation/model_comparison.hpp"

namespace elastocal {

/// The group of chains that each trial of a recording judges. Chains that share joints are one
/// group, named by the chains' names joined by "+" (section 6: head, arms and trunk are one group,
/// each leg is another).
std::vector<std::string> TrialGroups(const ErrorModel& model, const Recording& recording);

/// The models of `comparison` on trials that were not used for the estimate (section 6.1.4).
/// Joints, elasticity and markers are as estimated; only the support foot of each trial is placed
/// anew. There is one entry for each trial with postures.
struct HeldOut {
  ByModel<Prediction> predictions;
  ErrorTable table;  ///< Table 2
};

HeldOut JudgeOnTrials(const ModelComparison& comparison, const Recording& recording,
                      const CalibrationOptions& options);

/// The same of the largest model alone, in a fraction of the time: for a search that judges often.
HeldOut JudgeLargestOnTrials(const ModelComparison& comparison, const Recording& recording,
                             const CalibrationOptions& options);

/// Error of the waist in postures on one foot: root mean square of the distance between the true
/// origin of the root link and the one that the model predicts from the support foot, m.
/// `predicted` must be made with FootingBy::kFootMarkers. The place of the model's frame in the
/// waist is a convention. Its displacement from the true frame is therefore taken off first; it is
/// estimated from postures on two feet, where the waist's own markers locate the waist, or, without
/// these, from the same postures. NaN for fewer than two postures.
double WaistError(const Placement& predicted, const std::vector<std::optional<Transform>>& truth);

}  // namespace elastocal
