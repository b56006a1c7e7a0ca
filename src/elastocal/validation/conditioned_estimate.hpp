// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/validation/common_parameters.hpp"

namespace elastocal {

/// A parameter that one calibration estimates and another keeps at a value.
struct FixedParameter {
  std::string name;
  double value = 0.0;  ///< in the other calibration, SI
};

/// The parameters that `estimate` has and that the model of `other` keeps at a value: there they
/// are held, not in the model, or absent although `other` has geometry of their joint (springs,
/// causes) or of all joints of `estimate` (causes that belong to no joint: masses, the tilt of
/// gravity, the root). Not those of joints and legs that `other` does not know, nor biases of
/// sensors that it did not read, nor external ones. In the order of `estimate`.
std::vector<FixedParameter> FixedIn(const CalibrationEstimate& other,
                                    const CalibrationEstimate& estimate);

/// The estimate as it would be if these parameters had the values given: conditional mean and
/// covariance of the normal distribution that the file describes. The parameters become `held`.
/// Throws InputError if they are not in the covariance, or this is not positive definite.
CalibrationEstimate Conditioned(const CalibrationEstimate& estimate,
                                const std::vector<FixedParameter>& fixed);

}  // namespace elastocal
