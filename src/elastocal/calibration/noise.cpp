// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/noise.hpp"

#include <algorithm>
#include <set>

namespace elastocal {
namespace {

/// Joints that a trial exercises: those that move a seen marker, without the joints of the
/// supporting legs.
std::set<int> ExercisedJoints(const ErrorModel& model, const Recording& recording, int trial) {
  std::set<int> support;
  for (int link : recording.trials[trial].support) {
    for (int joint : JointsToBody(model.tree, model.tree.links[link].body)) support.insert(joint);
  }
  std::set<int> joints;
  for (int m = 0; m < model.marker_count(); ++m) {
    bool seen = false;
    for (int i = 0; i < recording.posture_count() && !seen; ++i) {
      seen = recording.trial[i] == trial && Seen(recording, i, m);
    }
    if (!seen) continue;
    for (int joint : JointsToBody(model.tree, model.tree.links[model.markers[m].link].body)) {
      if (!support.contains(joint)) joints.insert(joint);
    }
  }
  return joints;
}

}  // namespace

const char* NoiseSourceName(NoiseSource source) {
  static constexpr const char* kNames[] = {"marker", "body_position", "waist_position",
                                           "waist_rotation"};
  return kNames[static_cast<int>(source)];
}

std::vector<int> NoiseGroups(const ErrorModel& model, const Recording& recording) {
  if (recording.trials.empty()) return std::vector<int>(recording.posture_count(), 0);
  std::vector<std::set<int>> joints_of_group;
  std::vector<int> group_of_trial(recording.trials.size());
  for (std::size_t t = 0; t < recording.trials.size(); ++t) {
    std::set<int> joints = ExercisedJoints(model, recording, static_cast<int>(t));
    const auto group_count = static_cast<int>(joints_of_group.size());
    int group = group_count;
    for (int g = group_count - 1; g >= 0; --g) {
      std::vector<int> shared;
      std::set_intersection(joints.begin(), joints.end(), joints_of_group[g].begin(),
                            joints_of_group[g].end(), std::back_inserter(shared));
      if (shared.empty()) continue;
      if (group < group_count) {  // the trial joins two groups
        for (int& other : group_of_trial) other = other == group ? g : other;
        joints.insert(joints_of_group[group].begin(), joints_of_group[group].end());
        joints_of_group[group].clear();
      }
      group = g;
      joints.insert(joints_of_group[g].begin(), joints_of_group[g].end());
    }
    if (group == group_count) joints_of_group.emplace_back();
    joints_of_group[group] = std::move(joints);
    group_of_trial[t] = group;
  }
  // Numbers the groups without gaps, in the order of the postures. A refused trial has no posture
  // and no group.
  std::vector<int> order, groups;
  for (int trial : recording.trial) {
    const int group = group_of_trial[trial];
    const auto found = std::find(order.begin(), order.end(), group);
    groups.push_back(static_cast<int>(found - order.begin()));
    if (found == order.end()) order.push_back(group);
  }
  return groups;
}

}  // namespace elastocal
