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

/// Whether a parameter changes what loads the joints: the mass or first moment of a link, the tilt
/// of gravity.
bool IsLoad(const std::string& parameter);

/// Whether it is a compliance of a joint or a leg.
bool IsSpring(const std::string& parameter);

/// The estimate as a fit would give it that keeps these parameters at the values given: mean and
/// covariance of the normal distribution that the file describes, under that condition. A
/// compliance that would be negative is then kept at 0, as in a fit. The noise is larger by what
/// these parameters explained. They become `held`. All this is exact for a linear problem.
/// Throws InputError if they are not in the covariance, or this is not positive definite.
CalibrationEstimate Conditioned(const CalibrationEstimate& estimate,
                                const std::vector<FixedParameter>& fixed);

}  // namespace elastocal
