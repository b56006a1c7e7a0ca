// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "elastocal/calibration/sole_springs.hpp"

namespace elastocal {

/// Compliances of one sole in two calibrations, A and B, m/N.
struct SoleDifference {
  std::string leg;
  double a = 0.0, b = 0.0, sd = 0.0;  ///< `sd` is that of the difference b - a
  double half_width = 0.0;            ///< half width of the 95 % interval of b - a

  bool significant() const { return std::abs(b - a) > half_width; }
};

/// Compares the soles that both calibrations determine, in the order of B. The errors count as
/// independent; both share the errors of the described masses, which makes the interval too wide,
/// not too narrow.
std::vector<SoleDifference> CompareSoles(const std::vector<SoleSpring>& a,
                                         const std::vector<SoleSpring>& b);

}  // namespace elastocal
