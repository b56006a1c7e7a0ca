#pragma once

#include <map>
#include <string>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/validation/metrics.hpp"

namespace elastocal {

/// The fit of waist and markers to a recording, with the joints as given.
struct Refit {
  CalibrationResult result;
  ErrorMetrics metrics;      ///< over the observations that the calibrated model kept
  ErrorMetrics metrics_all;  ///< over all observations, outliers included
};

/// Errors of a calibration on a recording that was not used for it.
struct TransferValidation {
  Refit uncalibrated, calibrated;
};

/// Refits waist and markers of the nominal and of the calibrated robot (errors of joint parameters
/// by name, rad or m) to another recording. The calibrated model decides which observations are
/// outliers, so that both are judged on the same data.
TransferValidation ValidateTransfer(const ErrorModel& model, const Recording& recording,
                                    const BaseParameters& base, const CalibrationOptions& options,
                                    const std::map<std::string, double>& joint_errors);

}  // namespace elastocal
