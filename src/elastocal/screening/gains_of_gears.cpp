// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/gains_of_gears.hpp"

#include "elastocal/math/numbers.hpp"

namespace elastocal {

std::vector<RecordingFault> GainsOfGears(const CalibrationResult& result) {
  std::vector<RecordingFault> gains;
  for (int i = 0; i < result.model.parameter_count(); ++i) {
    const Parameter& parameter = result.model.parameters[Size(i)];
    if (parameter.correction < 0) continue;
    const Correction& correction = result.model.elasticity.corrections[Size(parameter.correction)];
    if (correction.shape != CorrectionShape::kGear) continue;
    gains.push_back({.coordinate = result.model.tree.joints[Size(correction.joint)].coordinate,
                     .size = 1.0 / (1.0 + result.delta[i]) - 1.0,
                     .sd = result.sd[i]});
  }
  return gains;
}

}  // namespace elastocal
