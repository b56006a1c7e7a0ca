// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/recording.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace elastocal {
namespace {

constexpr double kLeastJointStep = 2e-3;  // rad or m: less is no motion

}  // namespace

Eigen::Vector3d GravityBelow(const std::string& up) {
  if (!IsAxis(up)) throw std::invalid_argument("no axis: '" + up + "'");
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();
  gravity[up.back() - 'x'] = up.starts_with("-") ? 9.81 : -9.81;
  return gravity;
}

bool IsAxis(const std::string& text) {
  const std::string letter = text.starts_with('-') ? text.substr(1) : text;
  return letter == "x" || letter == "y" || letter == "z";
}

bool Seen(const Recording& recording, int posture, int marker) {
  return MarkerPosition(recording, posture, marker).allFinite();
}

Eigen::Vector3d MarkerPosition(const Recording& recording, int posture, int marker) {
  return recording.markers.block<1, 3>(posture, 3 * marker).transpose();
}

bool HasPoseByPosture(const Recording& recording) {
  return recording.free_root || !recording.trials.empty();
}

bool HasFreeRoot(const Recording& recording, int posture) {
  if (recording.trials.empty()) return recording.free_root;
  return recording.trials[recording.trial[posture]].free_root;
}

bool HasFreeRoot(const Recording& recording) {
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (!HasFreeRoot(recording, i)) return false;
  }
  return recording.posture_count() > 0;
}

Eigen::MatrixXd ApproachesOf(const Eigen::MatrixXd& q, const std::vector<int>& part) {
  Eigen::MatrixXd approach = Eigen::MatrixXd::Zero(q.rows(), q.cols());
  for (Eigen::Index i = 1; i < q.rows(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (!part.empty() && part[at] != part[at - 1]) continue;
    for (Eigen::Index c = 0; c < q.cols(); ++c) {
      const double step = q(i, c) - q(i - 1, c);
      const bool moved = std::abs(step) > kLeastJointStep;
      approach(i, c) = moved ? std::copysign(1.0, step) : approach(i - 1, c);
    }
  }
  return approach;
}

void NoteApproach(Recording& recording) {
  recording.approach = ApproachesOf(recording.q, recording.trial);
}

Recording SelectPostures(const Recording& recording, const std::vector<int>& postures) {
  Recording
      selected;  // not a copy of the whole: postures are taken one by one from long recordings
  selected.source = recording.source;
  selected.marker_names = recording.marker_names;
  selected.joints_not_recorded = recording.joints_not_recorded;
  selected.wrench_links = recording.wrench_links;
  selected.trials = recording.trials;
  selected.free_root = recording.free_root;
  selected.gravity = recording.gravity;
  selected.q = recording.q(postures, Eigen::all);
  selected.markers = recording.markers(postures, Eigen::all);
  if (recording.torques.rows() > 0) selected.torques = recording.torques(postures, Eigen::all);
  if (recording.wrenches.rows() > 0) selected.wrenches = recording.wrenches(postures, Eigen::all);
  if (!recording.trial.empty()) {
    selected.trial.clear();
    for (int posture : postures) selected.trial.push_back(recording.trial[posture]);
  }
  if (!recording.frames.empty()) {
    selected.frames.clear();
    for (int posture : postures) selected.frames.push_back(recording.frames[posture]);
  }
  if (recording.approach.rows() > 0) selected.approach = recording.approach(postures, Eigen::all);
  if (recording.time_s.size() > 0) selected.time_s = recording.time_s(postures);
  if (!recording.line.empty()) {
    selected.line.clear();
    for (int posture : postures) selected.line.push_back(recording.line[posture]);
  }
  return selected;
}

Recording EvenlyThinned(const Recording& recording, int most) {
  const int step = (recording.posture_count() + most - 1) / most;
  std::vector<int> kept;
  for (int i = 0; i < recording.posture_count(); i += step) kept.push_back(i);
  return SelectPostures(recording, kept);
}

namespace {

/// Stacks two matrices, one below the other; rows and columns that one of them lacks are NaN.
Eigen::MatrixXd Stacked(const Eigen::MatrixXd& above, int rows_above, const Eigen::MatrixXd& below,
                        int rows_below) {
  if (above.rows() == 0 && below.rows() == 0) return {};
  Eigen::MatrixXd stacked =
      Eigen::MatrixXd::Constant(rows_above + rows_below, std::max(above.cols(), below.cols()),
                                std::numeric_limits<double>::quiet_NaN());
  stacked.topLeftCorner(above.rows(), above.cols()) = above;
  stacked.block(rows_above, 0, below.rows(), below.cols()) = below;
  return stacked;
}

}  // namespace

Recording JoinTrials(const Recording& first, const Recording& second) {
  const int count = first.posture_count(), more = second.posture_count();
  Recording joined = first;
  joined.q = Stacked(first.q, count, second.q, more);
  joined.markers = Stacked(first.markers, count, second.markers, more);
  joined.torques = Stacked(first.torques, count, second.torques, more);
  if (first.wrench_links == second.wrench_links) {
    joined.wrenches = Stacked(first.wrenches, count, second.wrenches, more);
  } else {
    joined.wrench_links.clear();
    joined.wrenches.resize(0, 0);
  }
  joined.approach = Stacked(first.approach, count, second.approach, more).unaryExpr([](double d) {
    return std::isnan(d) ? 0.0 : d;
  });
  joined.time_s.resize(0);  // each trial has a clock of its own
  joined.line.clear();
  joined.frames.resize(first.frames.empty() && second.frames.empty() ? 0 : count, 1);
  for (int i = 0; i < more && !joined.frames.empty(); ++i) {
    joined.frames.push_back(second.frames.empty() ? 1 : second.frames[i]);
  }
  joined.trials.insert(joined.trials.end(), second.trials.begin(), second.trials.end());
  for (int trial : second.trial) {
    joined.trial.push_back(trial + static_cast<int>(first.trials.size()));
  }
  return joined;
}

}  // namespace elastocal
