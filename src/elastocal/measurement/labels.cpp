// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/labels.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

constexpr int kOpen = -1;  // the order of labels is not known from the frame itself

// Where distances are too much alike, labels that are exchanged for a moment show by their jumps.
constexpr double kSamePlace = 0.3;        // share of the cluster's least distance: same place
constexpr double kNoTimeToTurn_s = 0.1;   // longest time between the frames of a jump
constexpr double kLongestExchange_s = 2;  // between two jumps: beyond, one in between was not seen

// What to do with a cluster, frame by frame.
struct Plan {
  std::vector<int> order;                  // index into the shape's permutations, or kOpen
  std::vector<std::vector<bool>> removed;  // by raw marker and frame
  std::vector<bool> undecided;             // frame

  Plan(int frames, int size)
      : order(frames, kOpen), removed(size, std::vector<bool>(frames)), undecided(frames) {}
};

// The usual distances of a cluster's pairs, NaN where unknown; empty if nothing is known at all.
Eigen::VectorXd UsualOf(const std::vector<int>& markers, const std::vector<std::string>& names,
                        const PairDistances& usual) {
  if (usual.empty()) return {};
  const int size = static_cast<int>(markers.size());
  Eigen::VectorXd distances = Eigen::VectorXd::Constant(size * (size - 1) / 2, kNaN);
  for (int i = 0; i < size; ++i) {
    for (int j = i + 1; j < size; ++j) {
      const auto found = usual.find({names[markers[i]], names[markers[j]]});
      if (found != usual.end()) distances[PairColumn(i, j, size)] = found->second;
    }
  }
  return distances.array().isNaN().all() ? Eigen::VectorXd() : distances;
}

// Decides on each frame of one cluster by its distances.
class LabelFinder {
 public:
  LabelFinder(const std::vector<int>& markers, const LabelOptions& options,
              const MarkerTrajectories& trajectories)
      : markers_(markers),
        trajectories_(trajectories),
        table_(MeasureDistances(trajectories, markers)),
        shape_(MeasureShape(table_, static_cast<int>(markers.size()), options.tolerance_sd,
                            options.least_tolerance_m,
                            UsualOf(markers, trajectories.names, options.usual))),
        ambiguous_(!(shape_.separation >= options.least_separation)) {}

  const ClusterShape& shape() const { return shape_; }
  bool ambiguous() const { return ambiguous_; }

  bool IsSeen(int frame, int marker) const {
    return !std::isnan(trajectories_.positions(frame, 3 * markers_[marker]));
  }

  Plan Find() const {
    Plan plan(trajectories_.frame_count(), shape_.size);
    DecideWholeFrames(plan);
    if (ambiguous_) FindJumps(plan);
    // For undecided frames, the orders of the nearest decided frames.
    std::vector<int> after(plan.order.size(), kOpen);
    for (std::size_t i = plan.order.size(); i-- > 0;) {
      const bool last = i + 1 == plan.order.size();
      after[i] = plan.order[i] != kOpen ? plan.order[i] : (last ? kOpen : after[i + 1]);
    }
    int before = kOpen;
    for (int frame = 0; frame < trajectories_.frame_count(); ++frame) {
      if (plan.order[frame] != kOpen) {
        before = plan.order[frame];
      } else if (plan.undecided[frame]) {
        RemoveAll(frame, plan);
      } else {
        DecideByNeighbours(frame, before, after[frame], plan);
      }
    }
    return plan;
  }

 private:
  // Decides on the frames in which all markers are seen and fit in one order.
  void DecideWholeFrames(Plan& plan) const {
    int last = 0;
    for (int frame = 0; frame < trajectories_.frame_count(); ++frame) {
      if (!table_.row(frame).allFinite()) continue;
      int order = Fits(frame, 0) ? 0 : (Fits(frame, last) ? last : kOpen);
      const int count = static_cast<int>(shape_.permutations.size());
      for (int other = 1; order == kOpen && other < count; ++other) {
        if (Fits(frame, other)) order = other;
      }
      if (order > 0) last = order;
      plan.undecided[frame] = order > 0 && ambiguous_;
      if (!plan.undecided[frame]) plan.order[frame] = order;
    }
  }

  // Finds frames before which the markers jump to each other's places, and after which they jump
  // back.
  void FindJumps(Plan& plan) const {
    const int longest_pause =
        std::max(1, static_cast<int>(kNoTimeToTurn_s * trajectories_.rate_hz));
    const int longest_exchange = static_cast<int>(kLongestExchange_s * trajectories_.rate_hz);
    int seen = kOpen, jumped = kOpen;  // the last frames in which all are seen, or after a jump
    for (int frame = 0; frame < trajectories_.frame_count(); ++frame) {
      if (!table_.row(frame).allFinite()) continue;
      if (seen != kOpen && frame - seen <= longest_pause && Jump(seen, frame)) {
        const bool back = jumped != kOpen && frame - jumped <= longest_exchange;
        for (int k = jumped; back && k < frame; ++k) {
          plan.undecided[k] = true;
          plan.order[k] = kOpen;
        }
        jumped = back ? kOpen : frame;
      }
      seen = frame;
    }
  }

  // Whether each marker of a frame is in the place of a marker of an earlier frame, and some are
  // not in their own places.
  bool Jump(int before, int frame) const {
    const double near = kSamePlace * shape_.distances.minCoeff();
    const auto is_where = [&](int now, int earlier) {
      return (trajectories_.positions.block<1, 3>(frame, 3 * markers_[now]) -
              trajectories_.positions.block<1, 3>(before, 3 * markers_[earlier]))
                 .norm() < near;
    };
    bool jumped = false;
    for (int now = 0; now < shape_.size; ++now) {
      if (is_where(now, now)) continue;
      int place = 0;
      while (place < shape_.size && !is_where(now, place)) ++place;
      if (place == shape_.size) return false;
      jumped = true;
    }
    return jumped;
  }

  // Decides on a frame with hidden or outlying markers, by the orders of the frames around it and
  // by the order as recorded.
  void DecideByNeighbours(int frame, int before, int after, Plan& plan) const {
    if (before == kOpen) before = after == kOpen ? 0 : after;
    if (after == kOpen) after = before;
    if (before == after) {
      if (Try(frame, {before}, plan) || (before != 0 && Try(frame, {0}, plan))) return;
    } else if (Try(frame, {before, after, 0}, plan)) {
      return;
    }
    RemoveAll(frame, plan);
  }

  // Takes the first order that fits, if the others that fit give the same positions. Otherwise
  // takes the first order that fits without one marker.
  bool Try(int frame, const std::vector<int>& orders, Plan& plan) const {
    std::vector<int> fitting;
    for (const int order : orders) {
      if (Fits(frame, order)) fitting.push_back(order);
    }
    if (!fitting.empty()) {
      plan.order[frame] = fitting[0];
      for (const int order : fitting) {
        if (!SameForSeen(frame, fitting[0], order)) RemoveAll(frame, plan);
      }
      return true;
    }
    std::vector<int> blamed;  // raw markers
    int chosen = kOpen;
    for (const int order : orders) {
      const std::vector<int> outlying = OutlyingMarkers(frame, order);
      if (outlying.empty() || order == chosen) continue;
      if (chosen != kOpen && !SameForSeen(frame, chosen, order)) {
        RemoveAll(frame, plan);
        return true;
      }
      chosen = order;
      blamed = outlying;
    }
    if (chosen == kOpen) return false;
    plan.order[frame] = chosen;
    for (const int marker : blamed) plan.removed[marker][frame] = true;
    return true;
  }

  // Raw markers without which at least two others are left, and these fit.
  std::vector<int> OutlyingMarkers(int frame, int order) const {
    std::vector<int> outlying;
    int seen = 0;
    for (int marker = 0; marker < shape_.size; ++marker) seen += IsSeen(frame, marker);
    if (seen < 3) return outlying;
    for (int marker = 0; marker < shape_.size; ++marker) {
      const Permutation& permutation = shape_.permutations[order];
      if (IsSeen(frame, marker) && shape_.Fits(table_.row(frame), permutation, marker)) {
        outlying.push_back(marker);
      }
    }
    return outlying;
  }

  bool SameForSeen(int frame, int first, int second) const {
    const Permutation& a = shape_.permutations[first];
    const Permutation& b = shape_.permutations[second];
    for (int i = 0; i < shape_.size; ++i) {
      if (a[i] != b[i] && (IsSeen(frame, a[i]) || IsSeen(frame, b[i]))) return false;
    }
    return true;
  }

  void RemoveAll(int frame, Plan& plan) const {
    plan.order[frame] = 0;
    for (int marker = 0; marker < shape_.size; ++marker) {
      plan.removed[marker][frame] = IsSeen(frame, marker);
    }
  }

  bool Fits(int frame, int order) const {
    return shape_.Fits(table_.row(frame), shape_.permutations[order]);
  }

  const std::vector<int>& markers_;
  const MarkerTrajectories& trajectories_;
  DistanceTable table_;
  ClusterShape shape_;
  bool ambiguous_;
};

void CheckCluster(const LabelCluster& cluster, int marker_count) {
  std::vector<int> sorted = cluster.markers;
  std::sort(sorted.begin(), sorted.end());
  const bool in_range = sorted.empty() || (sorted.front() >= 0 && sorted.back() < marker_count);
  if (!in_range || std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) {
    throw std::invalid_argument("cluster " + cluster.name +
                                ": expected different markers from 0 to " +
                                std::to_string(marker_count - 1));
  }
}

// Whether label `i` of the cluster loses its position in a frame.
bool IsRemoved(const Plan& plan, const ClusterShape& shape, int frame, int i) {
  return plan.removed[shape.permutations[plan.order[frame]][i]][frame];
}

// Labels of a cluster that, in most of the frames that show them, do not fit although others of the
// cluster do.
std::vector<int> OffMostly(const LabelFinder& finder, const Plan& plan) {
  const ClusterShape& shape = finder.shape();
  const auto fits = [&](int frame, int i) {
    return finder.IsSeen(frame, shape.permutations[plan.order[frame]][i]) &&
           !IsRemoved(plan, shape, frame, i);
  };
  std::vector<int> off;
  for (int i = 0; i < shape.size; ++i) {
    int sightings = 0, alone = 0;
    for (int frame = 0; frame < static_cast<int>(plan.order.size()); ++frame) {
      if (!finder.IsSeen(frame, shape.permutations[plan.order[frame]][i])) continue;
      ++sightings;
      bool others = false;
      for (int k = 0; k < shape.size; ++k) others = others || (k != i && fits(frame, k));
      alone += others && !fits(frame, i);
    }
    if (2 * alone > sightings) off.push_back(i);
  }
  return off;
}

void RemoveThroughout(const LabelFinder& finder, int i, Plan& plan) {
  for (int frame = 0; frame < static_cast<int>(plan.order.size()); ++frame) {
    const int raw = finder.shape().permutations[plan.order[frame]][i];
    if (finder.IsSeen(frame, raw)) plan.removed[raw][frame] = true;
  }
}

// Carries out a plan.
void Apply(const Plan& plan, const ClusterShape& shape, const std::vector<int>& markers,
           Eigen::MatrixXd& positions) {
  std::vector<Eigen::RowVector3d> raw(markers.size());
  for (int frame = 0; frame < static_cast<int>(positions.rows()); ++frame) {
    InterruptionPoint();
    const auto position = [&](int i) { return positions.block<1, 3>(frame, 3 * markers[i]); };
    if (plan.order[frame] != 0) {
      for (int i = 0; i < shape.size; ++i) raw[i] = position(i);
      for (int i = 0; i < shape.size; ++i) {
        position(i) = raw[shape.permutations[plan.order[frame]][i]];
      }
    }
    for (int i = 0; i < shape.size; ++i) {
      if (IsRemoved(plan, shape, frame, i)) position(i).setConstant(kNaN);
    }
  }
}

ClusterLabels Report(const Plan& plan, const LabelFinder& finder, const LabelCluster& cluster) {
  const ClusterShape& shape = finder.shape();
  ClusterLabels labels;
  labels.name = cluster.name;
  labels.markers = cluster.markers;
  labels.ambiguous = finder.ambiguous();
  labels.distances = shape.distances;
  labels.tolerances = shape.tolerances;
  const int frames = static_cast<int>(plan.order.size());
  for (int begin = 0, end = 0; begin < frames; begin = end) {
    while (end < frames && plan.order[end] == plan.order[begin]) ++end;
    if (plan.order[begin] == 0) continue;
    labels.swaps.push_back({{begin, end}, shape.permutations[plan.order[begin]]});
  }
  for (int i = 0; i < shape.size; ++i) {
    for (const FrameInterval& run : RunsWhere(frames, [&](int frame) {
           return !plan.undecided[frame] && IsRemoved(plan, shape, frame, i);
         })) {
      labels.outliers.push_back({run, cluster.markers[i]});
    }
  }
  labels.undecided = RunsWhere(frames, [&](int frame) { return bool{plan.undecided[frame]}; });
  return labels;
}

}  // namespace

std::vector<ClusterLabels> CorrectLabels(const std::vector<LabelCluster>& clusters,
                                         const LabelOptions& options,
                                         MarkerTrajectories& trajectories) {
  std::vector<LabelFinder> finders;
  std::vector<Plan> plans;
  finders.reserve(clusters.size());
  struct Off {
    std::size_t finder = 0;
    int label = 0;
  };
  std::vector<Off> off;
  for (const LabelCluster& cluster : clusters) {
    CheckCluster(cluster, trajectories.marker_count());
    if (cluster.markers.size() < 2) continue;
    finders.emplace_back(cluster.markers, options, trajectories);
    plans.push_back(finders.back().Find());
    for (const int i : OffMostly(finders.back(), plans.back())) {
      off.push_back({finders.size() - 1, i});
    }
  }
  // One of each of two clusters: they have each other's labels, and fit for a while by chance. One
  // alone was displaced, and is right before or after.
  if (off.size() == 2 && off[0].finder != off[1].finder) {
    for (const Off& one : off) RemoveThroughout(finders[one.finder], one.label, plans[one.finder]);
  }
  std::vector<ClusterLabels> reports;
  std::size_t next = 0;
  for (const LabelCluster& cluster : clusters) {
    if (cluster.markers.size() < 2) {
      reports.emplace_back();
      reports.back().name = cluster.name;
      reports.back().markers = cluster.markers;
      reports.back().ambiguous = true;
      continue;
    }
    const LabelFinder& finder = finders[next];
    const Plan& plan = plans[next++];
    Apply(plan, finder.shape(), cluster.markers, trajectories.positions);
    reports.push_back(Report(plan, finder, cluster));
  }
  return reports;
}

}  // namespace elastocal
