// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/sole_changes.hpp"

#include <algorithm>

namespace elastocal {

std::vector<SoleDifference> CompareSoles(const std::vector<SoleSpring>& a,
                                         const std::vector<SoleSpring>& b) {
  std::vector<SoleDifference> differences;
  for (const SoleSpring& later : b) {
    const auto earlier = std::ranges::find(a, later.leg, &SoleSpring::leg);
    if (earlier == a.end() || !std::isfinite(earlier->sd) || !std::isfinite(later.sd)) continue;
    const double half_width =
        std::hypot(earlier->interval_factor * earlier->sd, later.interval_factor * later.sd);
    differences.push_back({later.leg, earlier->compliance, later.compliance,
                           std::hypot(earlier->sd, later.sd), half_width});
  }
  return differences;
}

}  // namespace elastocal
