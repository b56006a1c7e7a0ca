// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/placing_markers.hpp"

#include <map>
#include <utility>

#include "elastocal/math/transform.hpp"

namespace elastocal {
namespace {

Eigen::Matrix3Xd PositionsInBody(const ErrorModel& model, const std::vector<int>& markers) {
  Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(markers.size()));
  for (std::size_t k = 0; k < markers.size(); ++k) {
    const Marker& marker = model.markers[markers[k]];
    positions.col(static_cast<Eigen::Index>(k)) =
        model.tree.links[marker.link].T_body_link * marker.p_link_marker;
  }
  return positions;
}

}  // namespace

Eigen::Matrix3Xd MarkersOnBody(const ErrorModel& model, int body) {
  std::vector<int> markers;
  for (int m = 0; m < model.marker_count(); ++m) {
    if (model.tree.links[model.markers[m].link].body == body) markers.push_back(m);
  }
  return PositionsInBody(model, markers);
}

std::vector<int> PlacingMarkers(const ErrorModel& model, const Recording& recording, int posture) {
  using Place = std::pair<std::size_t, int>;  // joints from the root, body
  std::map<Place, std::vector<int>> on_body;
  for (int m = 0; m < recording.marker_count(); ++m) {
    if (!Seen(recording, posture, m)) continue;
    const int body = model.tree.links[model.markers[m].link].body;
    on_body[{JointsToBody(model.tree, body).size(), body}].push_back(m);
  }
  if (!HasFreeRoot(recording, posture)) return on_body[{0, 0}];
  for (const auto& [place, markers] : on_body) {
    if (TellPose(PositionsInBody(model, markers))) return markers;
  }
  return {};
}

}  // namespace elastocal
