// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/split_markers.hpp"

#include "elastocal/math/numbers.hpp"

namespace elastocal {

void SplitMarker(int marker, const std::string& name, const std::vector<char>& there,
                 Recording& recording) {
  recording.marker_names.push_back(name);
  recording.markers.conservativeResize(Eigen::NoChange, recording.markers.cols() + 3);
  recording.markers.rightCols<3>().setConstant(kNaN);
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (there[Size(i)] == 0) continue;
    auto seen = recording.markers.block<1, 3>(i, 3 * marker);
    recording.markers.rightCols<3>().row(i) = seen;
    seen.setConstant(kNaN);
  }
}

void SplitMarkersOf(const std::vector<int>& markers, const std::vector<std::string>& names,
                    const std::vector<char>& there, ErrorModel& model, Recording& recording) {
  ErrorModel extended = model;
  for (std::size_t k = 0; k < markers.size(); ++k) {
    extended.markers.push_back(model.markers[markers[k]]);
    extended.markers.back().name = names[k];
    SplitMarker(markers[k], names[k], there, recording);
  }
  model = SelectMarkers(extended, recording.marker_names);
}

}  // namespace elastocal
