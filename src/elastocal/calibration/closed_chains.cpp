// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/closed_chains.hpp"

#include <algorithm>
#include <limits>

namespace elastocal {

void HideClosedChains(const RobotTree& tree, const std::vector<Marker>& markers,
                      Recording& recording) {
  const auto body = [&](int link) { return tree.links[link].body; };
  for (std::size_t m = 0; m < recording.marker_names.size(); ++m) {
    const auto marker = std::find_if(markers.begin(), markers.end(), [&](const Marker& known) {
      return known.name == recording.marker_names[m];
    });
    if (marker == markers.end()) continue;
    for (int i = 0; i < recording.posture_count(); ++i) {
      const std::vector<int>& support = recording.trials[recording.trial[i]].support;
      if (support.size() < 2 || std::none_of(support.begin(), support.end(), [&](int link) {
            return body(link) == body(marker->link);
          })) {
        continue;
      }
      recording.markers.block<1, 3>(i, 3 * static_cast<Eigen::Index>(m))
          .setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  }
}

}  // namespace elastocal
