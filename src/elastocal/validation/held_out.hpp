#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/validation/error_table.hpp"
#include "elastocal/validation/model_comparison.hpp"

namespace elastocal {

/// Which group of chains each trial of a recording judges: the trials' chains that share joints, by
/// their names, joined by "+" (section 6: head, arms and trunk are one group, each leg another).
std::vector<std::string> TrialGroups(const ErrorModel& model, const Recording& recording);

/// The models of `comparison` on trials that took no part in the estimate (section 6.1.4): joints,
/// elasticity and markers as estimated, only the support foot of each trial placed anew. One entry
/// a trial with postures.
struct HeldOut {
  ByModel<Prediction> predictions;
  ErrorTable table;  ///< Table 2
};

HeldOut JudgeOnTrials(const ModelComparison& comparison, const Recording& recording,
                      const CalibrationOptions& options);

/// How far the waist is from where a model puts it on its standing foot, in postures on one foot:
/// root mean square over them of the distance between true and predicted origin of the root link,
/// m. `predicted` with FootingBy::kFootMarkers. Where in the waist the model's frame is, is a
/// convention: its displacement from the true one is taken from postures on two feet, where the
/// waist's own markers place it, or, without any, from the same postures. NaN for fewer than two.
double WaistError(const Placement& predicted, const std::vector<std::optional<Transform>>& truth);

}  // namespace elastocal
