// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/turned_axes.hpp"

#include <cmath>
#include <numbers>

#include "elastocal/math/numbers.hpp"

namespace elastocal {

std::vector<int> TurnedAxes(const CalibrationResult& result) {
  constexpr double kRightAngle = 0.5 * std::numbers::pi;
  std::vector<int> turned;
  for (int p = 0; p < result.model.parameter_count(); ++p) {
    const Parameter& parameter = result.model.parameters[Size(p)];
    const bool turns_axis = parameter.kind == ParameterKind::kAlpha ||
                            parameter.kind == ParameterKind::kBeta ||
                            parameter.kind == ParameterKind::kGamma;
    if (!turns_axis || std::abs(result.delta[p]) < kRightAngle) continue;
    if (turned.empty() || turned.back() != parameter.joint) turned.push_back(parameter.joint);
  }
  return turned;
}

}  // namespace elastocal
