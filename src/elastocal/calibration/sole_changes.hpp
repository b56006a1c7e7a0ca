// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "elastocal/calibration/sole_springs.hpp"

namespace elastocal {

/// What became of the spring of one sole between two calibrations, m/N.
struct SoleDifference {
  std::string leg;
  double a = 0.0, b = 0.0, sd = 0.0;  ///< `sd`: of the difference
  double half_width = 0.0;            ///< of the 95 % interval of b - a

  bool significant() const { return std::abs(b - a) > half_width; }
};

/// Of the soles of which both tell something, in the order of B. Errors are taken to be
/// independent; what both owe to the same described masses makes the interval too wide, not too
/// narrow.
std::vector<SoleDifference> CompareSoles(const std::vector<SoleSpring>& a,
                                         const std::vector<SoleSpring>& b);

}  // namespace elastocal
