#pragma once

#include <map>
#include <string>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/validation/metrics.hpp"

namespace elastocal {

/// Joints as given, waist and markers fitted to a recording.
struct Refit {
  CalibrationResult result;
  ErrorMetrics metrics;      ///< over the observations that the calibrated model kept
  ErrorMetrics metrics_all;  ///< over all, outliers included
};

/// A calibration on a recording that it was not made from.
struct TransferValidation {
  Refit uncalibrated, calibrated;
};

/// Refits waist and markers of the nominal and of the calibrated robot (errors of joint parameters
/// by name, rad or m) to another recording. The calibrated model decides what is an outlier, so
/// that both are judged on the same data.
TransferValidation ValidateTransfer(const ErrorModel& model, const Recording& recording,
                                    const BaseParameters& base, const CalibrationOptions& options,
                                    const std::map<std::string, double>& joint_errors);

}  // namespace elastocal
