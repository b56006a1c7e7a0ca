// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "elastocal/validation/error_table.hpp"
#include "elastocal/validation/metrics.hpp"
#include "elastocal/validation/model_comparison.hpp"

namespace elastocal {

/// What a user deploys, and its 3-D RMSE [m]: of the URDF alone, which is rigid, and of the URDF
/// with elastic compensation. NaN where there is none.
struct Deployment {
  /// Model whose geometry the URDF has: kGeometric, or kRigid where the full model without its
  /// springs predicts better than a geometry that was fitted without springs.
  ModelKind urdf_kind = ModelKind::kGeometric;
  std::string judged_on;  ///< "held-out trials", "held-out postures" or "the fit"
  double uncalibrated = 0.0, urdf = 0.0, compensated = 0.0;
  /// 95 % intervals by the scatter of held-out postures (IntervalOfRmse). Empty unless these judge.
  std::optional<RmseInterval> urdf_interval = {}, compensated_interval = {};
};

/// Chooses the geometry of the URDF. It is judged by held-out trials if there are any (`table` is
/// not null or empty), else by the folds of the cross-validation, else by the fit itself. Trials or
/// folds of which nothing could be predicted judge nothing.
Deployment ChooseDeployment(const ModelComparison& comparison, const CrossValidation& validation,
                            const ErrorTable* table);

/// Factor of ExpectedError beyond which an error is implausible: the robot is not the described
/// one, or the recording is wrong.
inline constexpr double kImplausible = 2.0;

/// Ratio of two errors on the same data above which one is worse by more than chance.
inline constexpr double kWorseBeyondChance = 1.05;

/// Expected error of a robot that was never calibrated, m: root mean square over the observations
/// of a recording (about 50 postures) and over 20 robots whose geometry is drawn from the prior.
double ExpectedError(const ErrorModel& model, const Recording& recording, const Prior& prior);

}  // namespace elastocal
