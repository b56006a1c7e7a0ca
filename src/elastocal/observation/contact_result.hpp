// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/observation/observation_fit.hpp"

namespace elastocal {

/// The parameters of the robot in the form of other calibrations: values, covariance, and status by
/// the observations. `equations` is the number of observed numbers.
CalibrationResult ResultOfContacts(const ObservedRobot& model, const ObservationFit& fit,
                                   int equations);

/// Information of the observations alone about the robot. `posterior` has `data_information` and
/// one parameter for each unknown (parameters in common have one value), but no covariance.
CalibrationResult InformationOfContacts(const ObservedRobot& model,
                                        const Observations& observations,
                                        const ObservationFit& fit);

}  // namespace elastocal
