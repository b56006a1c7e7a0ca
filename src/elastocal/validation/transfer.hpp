// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
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
  int not_predicted = 0;  ///< observations
};

/// Refits waist and markers of a robot with these errors of joint parameters (by name, rad or m).
Refit RefitTo(const ErrorModel& model, const Recording& recording, const BaseParameters& base,
              const CalibrationOptions& options, const std::map<std::string, double>& joint_errors);

/// Refits waist and markers of the nominal and of the calibrated robot (errors of joint parameters
/// by name, rad or m) to another recording. The calibrated model decides which observations are
/// outliers, so that both are judged on the same data.
TransferValidation ValidateTransfer(const ErrorModel& model, const Recording& recording,
                                    const BaseParameters& base, const CalibrationOptions& options,
                                    const std::map<std::string, double>& joint_errors);

/// The same of other errors of the joints, on the observations that `calibrated` kept.
Refit RefitLike(const Refit& calibrated, const ErrorModel& model, const Recording& recording,
                const BaseParameters& base, const CalibrationOptions& options,
                const std::map<std::string, double>& joint_errors);

/// Everything of a calibration that a prediction needs, by parameter name, SI.
struct FrozenCalibration {
  std::optional<Transform> T_ref_waist;  ///< of a table of postures
  std::map<std::string, double> joint_errors, externals, uncalibrated_externals;
};

/// Errors of the model by name, SI: those of joints and legs, and of what belongs to the
/// experiment. What is not named is 0.
Eigen::VectorXd ErrorsByName(const ErrorModel& model, const std::map<std::string, double>& joints,
                             const std::map<std::string, double>& externals);

/// Errors of a calibration on another recording to which nothing is fitted: waist pose and marker
/// positions are those of the calibration (of trials, each footing is placed anew: the robot stands
/// elsewhere). The cameras must not have been moved between two tables of postures, nor the
/// markers. `metrics` and `metrics_all` are the same, over all observations; an observation of a
/// marker that the calibration does not have is not predicted.
TransferValidation ValidateFrozen(const ErrorModel& model, const Recording& recording,
                                  const CalibrationOptions& options,
                                  const FrozenCalibration& calibration);

}  // namespace elastocal
