// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"

namespace elastocal {

/// A "calibration" with random errors of all joint parameters, for tests that need no estimate.
inline CalibrationResult WithErrors(const RobotTree& tree, std::uint64_t seed) {
  using Kind = ParameterKind;
  std::vector<Marker> markers;  // one on every link, so that the model has all joints
  for (std::size_t i = 0; i < tree.links.size(); ++i) {
    markers.push_back({"m" + std::to_string(i), static_cast<int>(i), {0.1, 0.02, -0.03}});
  }
  CalibrationResult result;
  result.model = MakeErrorModel(tree, markers);
  std::vector<int> all;
  for (int i = 0; i < result.model.parameter_count(); ++i) all.push_back(i);
  result.delta = DrawErrors(result.model, all,
                            {{Kind::kTheta, 0.02},
                             {Kind::kR, 2e-3},
                             {Kind::kD, 2e-3},
                             {Kind::kB, 2e-3},
                             {Kind::kAlpha, 0.01},
                             {Kind::kBeta, 0.01},
                             {Kind::kGamma, 0.01}},
                            seed);
  return result;
}

}  // namespace elastocal
