// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/foot_rests.hpp"

#include <algorithm>
#include <numeric>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/measurement/weight_shares.hpp"

namespace elastocal {
namespace {

/// Columns of the recording's markers on the body of a link.
std::vector<int> MarkersOnBody(const RobotTree& tree, const std::vector<Marker>& markers, int link,
                               const Recording& recording) {
  std::vector<int> found;
  for (int m = 0; m < recording.marker_count(); ++m) {
    const auto marker = std::ranges::find(markers, recording.marker_names[Size(m)], &Marker::name);
    if (marker == markers.end()) continue;
    if (tree.links[Size(marker->link)].body == tree.links[Size(link)].body) found.push_back(m);
  }
  return found;
}

Eigen::Matrix3Xd MostlyAt(const Recording& recording, const std::vector<int>& postures,
                          const std::vector<int>& markers) {
  Eigen::Matrix3Xd at(3, static_cast<Eigen::Index>(markers.size()));
  for (std::size_t k = 0; k < markers.size(); ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> values;
      for (int i : postures) {
        if (Seen(recording, i, markers[k])) {
          values.push_back(MarkerPosition(recording, i, markers[k])[axis]);
        }
      }
      at(axis, static_cast<Eigen::Index>(k)) = Median(values);
    }
  }
  return at;
}

}  // namespace

std::vector<FootRest> FindFootRests(const RobotTree& tree, const std::vector<Marker>& markers,
                                    const Recording& recording) {
  std::vector<std::vector<int>> postures(recording.trials.size());
  for (std::size_t i = 0; i < recording.trial.size(); ++i) {
    postures[Size(recording.trial[i])].push_back(static_cast<int>(i));
  }
  std::vector<FootRest> rests;
  for (std::size_t t = 0; t < postures.size(); ++t) {
    if (postures[t].empty()) continue;
    const Trial& trial = recording.trials[t];
    const auto middle = postures[t].begin() + static_cast<std::ptrdiff_t>(postures[t].size() / 2);
    for (int link : trial.support) {
      const std::vector<int> on = MarkersOnBody(tree, markers, link, recording);
      FootRest rest{.link = link, .session = trial.session, .trial = static_cast<int>(t)};
      for (int m : on) rest.markers.push_back(recording.marker_names[Size(m)]);
      rest.at = MostlyAt(recording, postures[t], on);
      rest.at_first = MostlyAt(recording, {postures[t].begin(), middle}, on);
      rest.at_last = MostlyAt(recording, {middle, postures[t].end()}, on);
      rests.push_back(std::move(rest));
    }
  }
  std::vector<int> same(recording.trials.size());
  std::iota(same.begin(), same.end(), 0);
  ShareWeights(tree, markers, recording, same, rests);
  return rests;
}

}  // namespace elastocal
