// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/validation/common_parameters.hpp"

namespace elastocal {

/// A parameter that one calibration estimates and the other keeps at a value.
struct FixedParameter {
  std::string name;
  double value = 0.0;  ///< its value in the other calibration, SI
};

/// The parameters that `estimate` has and that the model of `other` keeps at a value, in the order
/// of `estimate`. In `other` they are held, not in the model, or absent although `other` has
/// geometry of their joint (springs, causes) or of all joints of `estimate` (causes that belong to
/// no joint: masses, the tilt of gravity, the root). Parameters of joints and legs that `other`
/// does not know, biases of sensors that it did not read, and external parameters are left out.
std::vector<FixedParameter> FixedIn(const CalibrationEstimate& other,
                                    const CalibrationEstimate& estimate);

/// Whether a parameter changes the loads of the joints: mass or first moment of a link, tilt of
/// gravity.
bool IsLoad(const std::string& parameter);

/// Whether a parameter is a compliance of a joint or a leg.
bool IsSpring(const std::string& parameter);

/// The estimate that a fit with the parameters `fixed` at the given values would give: mean and
/// covariance of the normal distribution in the file, under that condition. This is exact for a
/// linear problem. A compliance that would become negative is fixed at 0, as in a fit. The noise
/// grows by what the fixed parameters explained. The fixed parameters get the status held. Throws
/// InputError if one of them is not in the covariance, or if the covariance is not positive
/// definite.
CalibrationEstimate Conditioned(const CalibrationEstimate& estimate,
                                const std::vector<FixedParameter>& fixed);

}  // namespace elastocal
