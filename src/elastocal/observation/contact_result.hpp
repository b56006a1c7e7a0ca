// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/observation/observation_fit.hpp"

namespace elastocal {

/// The parameters of the robot as other calibrations have them: values, covariance, which of them
/// the observations determined. `equations`: numbers observed.
CalibrationResult ResultOfContacts(const ObservedRobot& model, const ObservationFit& fit,
                                   int equations);

/// What the observations alone say of the robot: `posterior` has `data_information` and one
/// parameter for each unknown (those in common have one value), but no covariance.
CalibrationResult InformationOfContacts(const ObservedRobot& model,
                                        const Observations& observations,
                                        const ObservationFit& fit);

}  // namespace elastocal
