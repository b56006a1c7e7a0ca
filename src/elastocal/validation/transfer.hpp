// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/validation/metrics.hpp"

namespace elastocal {

/// Fit of waist and markers to a recording, with given errors of the joints.
struct Refit {
  CalibrationResult result;
  ErrorMetrics metrics;      ///< over the observations that the calibrated model kept
  ErrorMetrics metrics_all;  ///< over all observations, outliers included
};

/// Errors of a calibration on a recording that was not used for it.
struct TransferValidation {
  Refit uncalibrated, calibrated;
  int not_predicted = 0;  ///< number of observations that could not be predicted
};

/// Fits waist and markers of a robot with given errors of joint parameters (by name, rad or m).
Refit RefitTo(const ErrorModel& model, const Recording& recording, const BaseParameters& base,
              const CalibrationOptions& options, const std::map<std::string, double>& joint_errors);

/// Fits waist and markers of the nominal and of the calibrated robot to another recording.
/// `joint_errors` are the calibrated ones, by name, rad or m. The calibrated model decides which
/// observations are outliers, so that both are judged on the same data.
TransferValidation ValidateTransfer(const ErrorModel& model, const Recording& recording,
                                    const BaseParameters& base, const CalibrationOptions& options,
                                    const std::map<std::string, double>& joint_errors);

/// As RefitTo, on the observations that `calibrated` kept.
Refit RefitLike(const Refit& calibrated, const ErrorModel& model, const Recording& recording,
                const BaseParameters& base, const CalibrationOptions& options,
                const std::map<std::string, double>& joint_errors);

/// All of a calibration that a prediction needs, by parameter name, SI.
struct FrozenCalibration {
  std::optional<Transform> T_ref_waist;  ///< pose of the waist in a posture table
  std::map<std::string, double> joint_errors, externals, uncalibrated_externals;
};

/// Vector of a model's errors from their names, SI: those of joints and legs, and external ones. A
/// parameter that is not named is 0.
Eigen::VectorXd ErrorsByName(const ErrorModel& model, const std::map<std::string, double>& joints,
                             const std::map<std::string, double>& externals);

/// Errors of a calibration on another recording, to which nothing is fitted. Waist pose and marker
/// positions are those of the calibration; in trials each footing is placed anew, because the robot
/// stands elsewhere. Between two posture tables neither the cameras nor the markers must have been
/// moved. `metrics` and `metrics_all` are equal, over all observations. An observation of a marker
/// that the calibration does not have is not predicted.
TransferValidation ValidateFrozen(const ErrorModel& model, const Recording& recording,
                                  const CalibrationOptions& options,
                                  const FrozenCalibration& calibration);

}  // namespace elastocal
