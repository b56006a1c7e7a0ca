// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/merge_trials.hpp"

#include <algorithm>
#include <set>

#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

// Stacks a matrix of all trials, one below the other.
template <typename Member>
Eigen::MatrixXd Stack(const std::vector<TrialSamples>& trials, Eigen::Index columns,
                      Member member) {
  Eigen::Index rows = 0;
  for (const TrialSamples& trial : trials) rows += static_cast<Eigen::Index>(trial.frames.size());
  Eigen::MatrixXd stacked(rows, columns);
  Eigen::Index row = 0;
  for (const TrialSamples& trial : trials) {
    if (trial.frames.empty()) continue;
    const auto& part = trial.*member;
    stacked.middleRows(row, part.rows()) = part;
    row += part.rows();
  }
  return stacked;
}

void KeepSeenMarkers(const MarkedRobot& robot, Recording& recording) {
  std::vector<int> columns;
  for (std::size_t m = 0; m < robot.markers.size(); ++m) {
    const int column = 3 * static_cast<int>(m);
    if (recording.markers.col(column).array().isNaN().all()) continue;
    recording.marker_names.push_back(robot.markers[m].name);
    for (int axis = 0; axis < 3; ++axis) columns.push_back(column + axis);
  }
  recording.markers = recording.markers(Eigen::all, columns).eval();
}

// Puts the sensors of different trials side by side, by their links.
void StackWrenches(const std::vector<TrialSamples>& trials, Recording& recording) {
  std::set<int> links;
  for (const TrialSamples& trial : trials) {
    links.insert(trial.wrench_links.begin(), trial.wrench_links.end());
  }
  if (links.empty()) return;
  recording.wrench_links.assign(links.begin(), links.end());
  recording.wrenches.setConstant(recording.posture_count(),
                                 6 * static_cast<Eigen::Index>(links.size()), kNaN);
  Eigen::Index row = 0;
  for (const TrialSamples& trial : trials) {
    const auto rows = static_cast<Eigen::Index>(trial.frames.size());
    for (std::size_t i = 0; i < trial.wrench_links.size() && rows > 0; ++i) {
      const auto position = std::distance(links.begin(), links.find(trial.wrench_links[i]));
      recording.wrenches.block(row, 6 * position, rows, 6) =
          trial.wrenches.middleCols(6 * static_cast<Eigen::Index>(i), 6);
    }
    row += rows;
  }
}

}  // namespace

Recording MergeTrials(const MarkedRobot& robot, const std::vector<TrialSamples>& trials,
                      const std::string& source) {
  Recording recording;
  recording.source = source;
  const auto coordinates = static_cast<Eigen::Index>(robot.tree.coordinate_count());
  recording.q = Stack(trials, coordinates, &TrialSamples::q);
  recording.markers =
      Stack(trials, 3 * static_cast<Eigen::Index>(robot.markers.size()), &TrialSamples::markers);
  recording.torques =
      Stack(trials, static_cast<Eigen::Index>(robot.tree.joints.size()), &TrialSamples::torques);
  if (recording.torques.array().isNaN().all()) recording.torques.resize(0, 0);
  recording.time_s = Stack(trials, 1, &TrialSamples::time_s);
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const TrialSamples& trial = trials[i];
    recording.trials.push_back(trial.summary.trial);
    recording.trial.insert(recording.trial.end(), trial.frames.size(), static_cast<int>(i));
    recording.frames.insert(recording.frames.end(), trial.frames.begin(), trial.frames.end());
  }
  StackWrenches(trials, recording);
  KeepSeenMarkers(robot, recording);
  return recording;
}

}  // namespace elastocal
