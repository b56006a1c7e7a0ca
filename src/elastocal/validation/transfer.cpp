#include "elastocal/validation/transfer.hpp"

#include "elastocal/calibration/prediction.hpp"

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

}  // namespace

TransferValidation ValidateTransfer(const ErrorModel& model, const Recording& recording,
                                    const BaseParameters& base, const CalibrationOptions& options,
                                    const std::map<std::string, double>& joint_errors) {
  TransferValidation validation;
  validation.calibrated =
      MakeRefit(RefitExternals(model, recording, base, options, joint_errors), recording, options);
  const Selection used{validation.calibrated.result.used, validation.calibrated.result.tied};
  validation.uncalibrated =
      MakeRefit(RefitExternals(model, recording, base, options, {}, &used), recording, options);
  return validation;
}

}  // namespace elastocal
