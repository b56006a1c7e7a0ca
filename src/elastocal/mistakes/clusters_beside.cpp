// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/clusters_beside.hpp"

#include <algorithm>
#include <set>

#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

std::set<int> BodiesOf(const LabelCluster& cluster, const ErrorModel& model) {
  std::set<int> bodies;
  for (const int marker : cluster.markers) {
    bodies.insert(model.tree.links[Size(model.markers[Size(marker)].link)].body);
  }
  return bodies;
}

}  // namespace

std::vector<LabelCluster> ClustersBeside(const std::vector<int>& coordinates,
                                         const std::vector<LabelCluster>& clusters,
                                         const ErrorModel& model) {
  const std::vector<Joint>& joints = model.tree.joints;
  std::set<int> marked;
  for (const LabelCluster& cluster : clusters) marked.merge(BodiesOf(cluster, model));
  std::vector<int> ways;  // bodies from which to go on
  std::set<int> reached;
  const auto reach = [&](int body) {
    if (reached.insert(body).second && !marked.contains(body)) ways.push_back(body);
  };
  // Joint k carries body k + 1.
  for (std::size_t k = 0; k < joints.size(); ++k) {
    if (!IsMovedBy(joints[k], coordinates)) continue;
    reach(joints[k].parent_body);
    reach(static_cast<int>(k) + 1);
  }
  while (!ways.empty()) {
    const int body = ways.back();
    ways.pop_back();
    for (std::size_t k = 0; k < joints.size(); ++k) {
      if (static_cast<int>(k) + 1 == body) reach(joints[k].parent_body);
      if (joints[k].parent_body == body) reach(static_cast<int>(k) + 1);
    }
  }
  std::vector<LabelCluster> beside;
  for (const LabelCluster& cluster : clusters) {
    const std::set<int> bodies = BodiesOf(cluster, model);
    if (std::any_of(bodies.begin(), bodies.end(), [&](int b) { return reached.contains(b); })) {
      beside.push_back(cluster);
    }
  }
  return beside;
}

}  // namespace elastocal
