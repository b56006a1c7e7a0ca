#include "elastocal/validation/transfer.hpp"

namespace elastocal {
namespace {

Refit MakeRefit(CalibrationResult result, const Recording& recording) {
  Refit refit;
  const Eigen::MatrixXd distances = ResidualNorms(result.model, recording, result.delta);
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
      MakeRefit(RefitExternals(model, recording, base, options, joint_errors), recording);
  validation.uncalibrated = MakeRefit(
      RefitExternals(model, recording, base, options, {}, &validation.calibrated.result.used),
      recording);
  return validation;
}

}  // namespace elastocal
