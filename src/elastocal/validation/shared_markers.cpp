// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/shared_markers.hpp"

#include <algorithm>
#include <map>
#include <numeric>

namespace elastocal {
namespace {

/// Two markers only tell their distance; a rotation about the line through them stays hidden.
constexpr std::size_t kFewestMarkers = 3;

std::map<std::string, int> EstimatedParameters(const CalibrationEstimate& estimate) {
  std::map<std::string, int> index;
  for (std::size_t i = 0; i < estimate.parameters.size(); ++i) {
    if (estimate.parameters[i].status != ParameterStatus::kEstimated) continue;
    index.emplace(estimate.parameters[i].name, static_cast<int>(i));
  }
  return index;
}

/// The p value of the differences of a link's markers, under the condition that the markers of all
/// other `same` links have not moved.
double TestAgainstOthers(const Differences& differences, const std::vector<std::vector<int>>& rows,
                         const std::vector<LinkMarkers>& links, std::size_t k) {
  std::vector<LinkMarkers> others = links;
  others[k].same = false;
  const Differences given = GivenNone(differences, rows[k], RowsOfUnmoved(rows, others));
  std::vector<int> all(rows[k].size());
  std::iota(all.begin(), all.end(), 0);
  return TestDifferences(given, all).p;
}

}  // namespace

std::vector<int> RowsOfUnmoved(const std::vector<std::vector<int>>& rows,
                               const std::vector<LinkMarkers>& links) {
  std::vector<int> unmoved;
  for (std::size_t k = 0; k < links.size(); ++k) {
    if (links[k].same) unmoved.insert(unmoved.end(), rows[k].begin(), rows[k].end());
  }
  return unmoved;
}

std::vector<LinkMarkers> FindCommonMarkers(const std::vector<MarkerPlace>& a,
                                           const std::vector<MarkerPlace>& b) {
  std::map<std::string, std::string> link_in_a;
  for (const MarkerPlace& marker : a) link_in_a.emplace(marker.name, marker.link);
  std::vector<LinkMarkers> links;
  for (const MarkerPlace& marker : b) {
    const auto in_a = link_in_a.find(marker.name);
    if (in_a == link_in_a.end() || in_a->second != marker.link) continue;
    auto link = std::find_if(links.begin(), links.end(),
                             [&](const LinkMarkers& one) { return one.link == marker.link; });
    if (link == links.end()) {
      link = links.insert(link, {.link = marker.link, .markers = {}});
    }
    link->markers.push_back(marker.name);
  }
  std::erase_if(links,
                [](const LinkMarkers& link) { return link.markers.size() < kFewestMarkers; });
  return links;
}

std::vector<MarkerCoordinate> CoordinatesOf(const LinkMarkers& link, const CalibrationEstimate& a,
                                            const CalibrationEstimate& b) {
  const std::map<std::string, int> in_a = EstimatedParameters(a), in_b = EstimatedParameters(b);
  const auto nominal = [](const CalibrationEstimate& estimate, const std::string& name) {
    return std::ranges::find(estimate.markers, name, &MarkerPlace::name)->nominal;
  };
  std::vector<MarkerCoordinate> coordinates;
  for (const std::string& marker : link.markers) {
    const Eigen::Vector3d moved = nominal(b, marker) - nominal(a, marker);
    for (int axis = 0; axis < 3; ++axis) {
      const std::string name = "marker." + marker + "." + "xyz"[axis];
      const auto at_a = in_a.find(name), at_b = in_b.find(name);
      if (at_a == in_a.end() || at_b == in_b.end()) return {};
      coordinates.push_back({at_a->second, at_b->second, moved[axis]});
    }
  }
  return coordinates;
}

void FindUnmovedMarkers(const Differences& differences, const std::vector<std::vector<int>>& rows,
                        double level, std::vector<LinkMarkers>& links) {
  for (LinkMarkers& link : links) link.same = true;
  while (true) {
    LinkMarkers* worst = nullptr;
    int count = 0;
    for (std::size_t k = 0; k < links.size(); ++k) {
      if (!links[k].same) continue;
      ++count;
      links[k].p = TestAgainstOthers(differences, rows, links, k);
      if (worst == nullptr || links[k].p < worst->p) worst = &links[k];
    }
    if (worst == nullptr || worst->p * count > level) return;
    worst->same = false;
  }
}

}  // namespace elastocal
