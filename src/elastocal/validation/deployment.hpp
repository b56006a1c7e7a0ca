// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "elastocal/validation/error_table.hpp"
#include "elastocal/validation/metrics.hpp"
#include "elastocal/validation/model_comparison.hpp"

namespace elastocal {

/// What a user takes home, and how well it predicts markers that were not used for it: the 3-D
/// RMSE [m] of the URDF alone, which is rigid, and of the URDF with elastic compensation. NaN where
/// there is none.
struct Deployment {
  /// Whose geometry the URDF has: kGeometric, or kRigid where leaving out the springs of the full
  /// model predicts better than a geometry that was fitted without them.
  ModelKind urdf_kind = ModelKind::kGeometric;
  std::string judged_on;  ///< "held-out trials", "held-out postures" or "the fit"
  double uncalibrated = 0.0, urdf = 0.0, compensated = 0.0;
  /// By the scatter of held-out postures (IntervalOfRmse); nothing where others judge.
  std::optional<RmseInterval> urdf_interval = {}, compensated_interval = {};
};

/// Judges by held-out trials where there are any (`table` is not null), else by the folds of the
/// cross-validation, else by the fit itself.
Deployment ChooseDeployment(const ModelComparison& comparison, const CrossValidation& validation,
                            const ErrorTable* table);

/// A robot that errs by more than this many times ExpectedError is not the one that was described,
/// or the recording is wrong.
inline constexpr double kImplausible = 2.0;

/// By how much a robot that was never calibrated is expected to err, m: root mean square over the
/// observations of a recording and over robots drawn from the prior (angles and lengths).
double ExpectedError(const ErrorModel& model, const Recording& recording, const Prior& prior);

}  // namespace elastocal
