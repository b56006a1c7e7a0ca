// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/transfer.hpp"

#include "elastocal/calibration/prediction.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

Refit MakeRefit(CalibrationResult result, const Recording& recording,
                const CalibrationOptions& options) {
  Refit refit;
  const Eigen::MatrixXd distances =
      Predict(result.model, result.delta, recording, options).distances;
  refit.metrics = ComputeMetrics(distances, result.used);
  refit.metrics_all = ComputeMetrics(distances, SeenMask(recording));
  refit.result = std::move(result);
  return refit;
}

Refit PredictFrozen(const ErrorModel& model, const Recording& recording,
                    const CalibrationOptions& options, const std::map<std::string, double>& joints,
                    const std::map<std::string, double>& externals) {
  Refit refit;
  refit.result.model = model;
  refit.result.delta = ErrorsByName(model, joints, externals);
  refit.result.used = SeenMask(recording);
  refit.result.termination = Termination::kConverged;
  Eigen::MatrixXd distances = Predict(model, refit.result.delta, recording, options).distances;
  for (int m = 0; m < recording.marker_count(); ++m) {
    if (externals.contains("marker." + recording.marker_names[m] + ".x")) continue;
    distances.col(m).setConstant(kNaN);
  }
  refit.metrics = refit.metrics_all = ComputeMetrics(distances, refit.result.used);
  return refit;
}

}  // namespace

Eigen::VectorXd ErrorsByName(const ErrorModel& model, const std::map<std::string, double>& joints,
                             const std::map<std::string, double>& externals) {
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(model.parameter_count());
  for (int i = 0; i < model.parameter_count(); ++i) {
    const Parameter& parameter = model.parameters[i];
    const auto& errors = IsExternal(parameter.kind) ? externals : joints;
    const auto error = errors.find(parameter.name);
    if (error != errors.end()) delta[i] = error->second;
  }
  return delta;
}

TransferValidation ValidateFrozen(const ErrorModel& model, const Recording& recording,
                                  const CalibrationOptions& options,
                                  const FrozenCalibration& calibration) {
  ErrorModel placed = model;
  if (calibration.T_ref_waist) placed.T_ref_waist = *calibration.T_ref_waist;
  TransferValidation validation;
  validation.calibrated =
      PredictFrozen(placed, recording, options, calibration.joint_errors, calibration.externals);
  validation.uncalibrated =
      PredictFrozen(placed, recording, options, {}, calibration.uncalibrated_externals);
  validation.not_predicted = static_cast<int>(validation.calibrated.result.used.count()) -
                             validation.calibrated.metrics.observations;
  return validation;
}

Refit RefitTo(const ErrorModel& model, const Recording& recording, const BaseParameters& base,
              const CalibrationOptions& options,
              const std::map<std::string, double>& joint_errors) {
  return MakeRefit(RefitExternals(model, recording, base, options, joint_errors), recording,
                   options);
}

TransferValidation ValidateTransfer(const ErrorModel& model, const Recording& recording,
                                    const BaseParameters& base, const CalibrationOptions& options,
                                    const std::map<std::string, double>& joint_errors) {
  TransferValidation validation;
  validation.calibrated = RefitTo(model, recording, base, options, joint_errors);
  validation.uncalibrated = RefitLike(validation.calibrated, model, recording, base, options, {});
  return validation;
}

Refit RefitLike(const Refit& calibrated, const ErrorModel& model, const Recording& recording,
                const BaseParameters& base, const CalibrationOptions& options,
                const std::map<std::string, double>& joint_errors) {
  const Selection used = Select(model, recording, calibrated.result.used, calibrated.result.tied);
  return MakeRefit(RefitExternals(model, recording, base, options, joint_errors, &used), recording,
                   options);
}

}  // namespace elastocal
