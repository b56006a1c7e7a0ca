// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/odd_postures.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/screening/placed_misfit.hpp"

namespace elastocal {
namespace {

constexpr int kFewestSoundPostures = 8;    // smallest number of postures that place a robot
constexpr double kOddDistance = 0.015;     // m
constexpr double kOddShare = 0.015;        // share of the robot's size, if that is smaller
constexpr double kOddRatio = 3.0;          // times the median of the postures that place the robot
constexpr double kOddOfCalibrated = 5e-4;  // m
// m, largest such median with which the robot counts as placed
constexpr double kSoundDistance = 0.05;
constexpr double kLeftOfOdd = 0.5;
constexpr int kFewestOddPostures = 3;
constexpr double kLeastShareOfOdd = 0.6;  // share of the odd postures
constexpr std::size_t kMostOddKinds = 2;
constexpr std::size_t kMostListedPostures = 8;
// Share of the squares of the difference between shown and logged positions.
constexpr double kLeastOfGain = 0.8;
constexpr int kToldGrid = 48;  // number of positions of a joint that are tried
constexpr int kToldHalvings = 12;

/// A possible mistake of a posture. `undo` corrects it; false where that is impossible.
struct PostureChange {
  std::string what;  ///< "arm_3_joint: the sign of its positions is reversed"
  std::function<bool(const Recording& of, int posture, Recording& corrected)> undo;
};

std::string ListOfPostures(const std::vector<int>& postures) {
  const bool run = postures.back() - postures.front() + 1 == static_cast<int>(postures.size());
  if (run && postures.size() > 2) {
    return " in postures " + std::to_string(postures.front() + 1) + " to " +
           std::to_string(postures.back() + 1);
  }
  std::string text = postures.size() > 1 ? " in postures " : " in posture ";
  for (std::size_t k = 0; k < std::min(postures.size(), kMostListedPostures); ++k) {
    text += (k == 0 ? "" : ", ") + std::to_string(postures[k] + 1);
  }
  if (postures.size() <= kMostListedPostures) return text;
  return text + " and " + std::to_string(postures.size() - kMostListedPostures) + " more";
}

class OddSearch {
 public:
  OddSearch(const ErrorModel& model, const Recording& recording,
            const std::vector<LabelCluster>& clusters, const Eigen::VectorXd* errors)
      : model_(model), recording_(recording), clusters_(clusters), errors_(errors) {
    Place();
  }

  std::vector<OddPostures> Run() {
    std::vector<OddPostures> found;
    Recording current = recording_;
    std::vector<int> left = odd_;
    if (static_cast<int>(left.size()) < kFewestOddPostures) return {};
    const std::vector<PostureChange> changes = Changes();
    while (found.size() < kMostOddKinds && static_cast<int>(left.size()) >= kFewestOddPostures) {
      std::optional<OddPostures> best = Best(changes, current, left);
      if (!best) best = Told(current, left);
      if (!best) break;
      current = best->corrected;
      std::erase_if(left, [&](int i) {
        return std::binary_search(best->postures.begin(), best->postures.end(), i);
      });
      found.push_back(std::move(*best));
    }
    // A mistake that explains only a few of them is chance.
    if (left.size() > (1.0 - kLeastShareOfOdd) * static_cast<double>(odd_.size())) return {};
    return found;
  }

 private:
  /// The robot placed by a part of the table: distance of each posture, and their median in that
  /// part, m.
  struct PlacedByPart {
    PlacedNominal robot;
    std::vector<double> distance;
    double median = 0.0;
  };

  void Place() {
    const int count = recording_.posture_count();
    const double least = errors_ != nullptr
                             ? kOddOfCalibrated
                             : std::min(kOddDistance, kOddShare * RobotSize(model_.tree));
    const std::pair<int, int> parts[] = {
        {0, count}, {0, count / 2}, {count / 2, count}, {0, count / 4}, {count - count / 4, count}};
    std::vector<PlacedByPart> placements;
    for (const auto& [begin, end] : parts) {
      if (end - begin < kFewestSoundPostures) continue;
      std::vector<int> rows(Size(end - begin));
      std::iota(rows.begin(), rows.end(), begin);
      auto placed = PlaceNominal(model_, SelectPostures(recording_, rows), errors_);
      if (!placed) continue;
      PlacedByPart one{std::move(*placed), {}, 0.0};
      for (int i = 0; i < count; ++i) one.distance.push_back(one.robot.Distance(recording_, i));
      one.median =
          Median(std::vector<double>(one.distance.begin() + begin, one.distance.begin() + end));
      placements.push_back(std::move(one));
    }
    double median = kSoundDistance;
    for (const PlacedByPart& one : placements) median = std::min(median, one.median);
    far_ = std::max(least, kOddRatio * median);
    int fewest = count - std::max(kFewestSoundPostures, count / 4) + 1;
    for (PlacedByPart& one : placements) {
      std::vector<int> odd;
      for (int i = 0; i < count; ++i) {
        if (one.distance[Size(i)] > far_) odd.push_back(i);
      }
      if (static_cast<int>(odd.size()) >= fewest) continue;
      fewest = static_cast<int>(odd.size());
      odd_ = std::move(odd);
      distance_ = std::move(one.distance);
      placed_ = std::move(one.robot);
    }
  }

  std::vector<int> MovedJoints() const {
    std::vector<int> joints;
    for (const int k : model_.active_joints) {
      const Joint& joint = model_.tree.joints[Size(k)];
      const auto column = recording_.q.col(joint.coordinate);
      if (joint.mimic || IsMovedByRods(model_.tree, k)) continue;
      if (column.maxCoeff() > column.minCoeff()) joints.push_back(k);
    }
    return joints;
  }

  const Joint& JointAt(int k) const { return model_.tree.joints[Size(k)]; }

  void AddChangesOf(const Joint& joint, std::vector<PostureChange>& changes) const {
    const int c = joint.coordinate;
    changes.push_back({joint.name + ": the sign of its positions is reversed",
                       [c](const Recording& of, int i, Recording& to) {
                         to.q(i, c) = -of.q(i, c);
                         return true;
                       }});
    for (const int by : {-1, 1}) {
      changes.push_back(
          {joint.name + ": its positions are those of the row " + (by < 0 ? "before" : "after"),
           [c, by](const Recording& of, int i, Recording& to) {
             if (i - by < 0 || i - by >= of.posture_count()) return false;
             to.q(i, c) = of.q(i - by, c);
             return true;
           }});
    }
    if (joint.type == JointType::kPrismatic) return;
    changes.push_back({joint.name + ": its positions are off by half a turn",
                       [c](const Recording& of, int i, Recording& to) {
                         to.q(i, c) = of.q(i, c) + std::numbers::pi;
                         return true;
                       }});
  }

  static PostureChange Exchanged(const Joint& a, const Joint& b) {
    return {a.name + " and " + b.name + ": their positions are exchanged",
            [c = a.coordinate, d = b.coordinate](const Recording& of, int i, Recording& to) {
              to.q(i, c) = of.q(i, d);
              to.q(i, d) = of.q(i, c);
              return true;
            }};
  }

  static PostureChange MarkersOfRow(int by) {
    return {std::string("the markers are those of the row ") + (by < 0 ? "before" : "after"),
            [by](const Recording& of, int i, Recording& to) {
              if (i + by < 0 || i + by >= of.posture_count()) return false;
              to.q.row(i) = of.q.row(i + by);
              return true;
            }};
  }

  static PostureChange Exchanged(const LabelCluster& a, const LabelCluster& b) {
    return {"the labels of " + a.name + " and " + b.name + " are exchanged",
            [x = a.markers, y = b.markers](const Recording& of, int i, Recording& to) {
              for (std::size_t k = 0; k < x.size(); ++k) {
                to.markers.row(i).segment<3>(3 * x[k]) = of.markers.row(i).segment<3>(3 * y[k]);
                to.markers.row(i).segment<3>(3 * y[k]) = of.markers.row(i).segment<3>(3 * x[k]);
              }
              return true;
            }};
  }

  std::vector<PostureChange> Changes() const {
    std::vector<PostureChange> changes;
    const std::vector<int> joints = MovedJoints();
    for (const int k : joints) AddChangesOf(JointAt(k), changes);
    for (std::size_t a = 0; a < joints.size(); ++a) {
      for (std::size_t b = a + 1; b < joints.size(); ++b) {
        changes.push_back(Exchanged(JointAt(joints[a]), JointAt(joints[b])));
      }
    }
    for (const int by : {-1, 1}) changes.push_back(MarkersOfRow(by));
    for (std::size_t a = 0; a < clusters_.size(); ++a) {
      for (std::size_t b = a + 1; b < clusters_.size(); ++b) {
        const bool alike = clusters_[a].markers.size() == clusters_[b].markers.size();
        if (alike) changes.push_back(Exchanged(clusters_[a], clusters_[b]));
      }
    }
    return changes;
  }

  bool Explains(double distance, int i) const {
    return distance < far_ && distance < kLeftOfOdd * distance_[Size(i)];
  }

  std::optional<OddPostures> Best(const std::vector<PostureChange>& changes,
                                  const Recording& current, const std::vector<int>& odd) const {
    std::optional<OddPostures> best;
    double best_mean = std::numeric_limits<double>::infinity();
    std::size_t best_change = 0;
    for (const PostureChange& change : changes) {
      InterruptionPoint();
      OddPostures one{change.what, {}, current};
      double sum = 0.0;
      for (const int i : odd) {
        if (!change.undo(current, i, one.corrected)) continue;
        const double distance = placed_->Distance(one.corrected, i);
        if (Explains(distance, i)) {
          one.postures.push_back(i);
          sum += distance;
        } else {
          one.corrected.q.row(i) = current.q.row(i);
          one.corrected.markers.row(i) = current.markers.row(i);
        }
      }
      const std::size_t most = best ? best->postures.size() : 0;
      const double mean = sum / std::max<double>(1.0, static_cast<double>(one.postures.size()));
      const bool better =
          one.postures.size() > most || (one.postures.size() == most && mean < best_mean);
      if (static_cast<int>(one.postures.size()) < kFewestOddPostures || !better) continue;
      best_mean = mean;
      best_change = static_cast<std::size_t>(&change - changes.data());
      best = std::move(one);
    }
    if (!best || best->postures.size() < kLeastShareOfOdd * static_cast<double>(odd.size())) {
      return std::nullopt;
    }
    FillStretch(changes[best_change], current, *best);
    best->what += ListOfPostures(best->postures);
    return best;
  }

  /// If most postures of a stretch have the mistake, and it can be hidden in the others, all have
  /// it: a joint near zero has either sign.
  void FillStretch(const PostureChange& change, const Recording& current,
                   OddPostures& found) const {
    const int begin = found.postures.front(), end = found.postures.back() + 1;
    if (static_cast<double>(found.postures.size()) < kLeastShareOfOdd * (end - begin)) return;
    Recording filled = found.corrected;
    std::vector<int> all;
    for (int i = begin; i < end; ++i) {
      all.push_back(i);
      if (std::binary_search(found.postures.begin(), found.postures.end(), i)) continue;
      if (!change.undo(current, i, filled) || placed_->Distance(filled, i) > far_) return;
    }
    found.postures = std::move(all);
    found.corrected = std::move(filled);
  }

  /// Tries another position of a joint, where the markers show it.
  std::optional<OddPostures> Told(const Recording& current, const std::vector<int>& odd) const {
    std::vector<PostureChange> changes;
    for (const int k : MovedJoints()) {
      const int c = model_.tree.joints[Size(k)].coordinate;
      const bool slides = model_.tree.joints[Size(k)].type == JointType::kPrismatic;
      const auto [least, most] = std::minmax_element(
          odd.begin(), odd.end(), [&](int a, int b) { return current.q(a, c) < current.q(b, c); });
      const bool same = !(current.q(*most, c) > current.q(*least, c));
      changes.push_back({model_.tree.joints[Size(k)].name +
                             (same ? ": its column says the same, which the markers contradict,"
                                   : ": its positions are wrong, the markers show others,"),
                         [this, c, slides](const Recording&, int i, Recording& to) {
                           const double middle = 0.0;
                           double step = 2.0 * (slides ? 1.0 : std::numbers::pi) / kToldGrid;
                           double best = middle,
                                  least_distance = std::numeric_limits<double>::infinity();
                           const auto look = [&](double at) {
                             to.q(i, c) = at;
                             const double distance = placed_->Distance(to, i);
                             if (!(distance < least_distance)) return;
                             least_distance = distance;
                             best = at;
                           };
                           for (int n = -kToldGrid / 2; n < kToldGrid / 2; ++n)
                             look(middle + n * step);
                           for (int n = 0; n < kToldHalvings; ++n) {
                             step *= 0.5;
                             const double around = best;
                             look(around - step);
                             look(around + step);
                           }
                           to.q(i, c) = best;
                           return true;
                         }});
    }
    std::optional<OddPostures> told = Best(changes, current, odd);
    const bool by_gain =
        told && std::any_of(changes.begin(), changes.end(), [&](const PostureChange& one) {
          return told->what.starts_with(one.what) && IsGain(one, current);
        });
    return by_gain ? std::nullopt : told;
  }

  /// Whether the difference between shown and logged positions of a joint grows, over all postures,
  /// with the distance from where it is correct.
  static bool IsGain(const PostureChange& change, const Recording& current) {
    Recording told = current;
    for (int i = 0; i < current.posture_count(); ++i) change.undo(current, i, told);
    Eigen::MatrixXd by = told.q - current.q;
    by = by.unaryExpr([](double d) { return std::remainder(d, 2.0 * std::numbers::pi); });
    Eigen::Index c = 0;  // the only joint that is shown
    by.colwise().squaredNorm().maxCoeff(&c);
    const Eigen::VectorXd x = current.q.col(c).array() - current.q.col(c).mean();
    const Eigen::VectorXd d = by.col(c).array() - by.col(c).mean();
    const double explained = std::pow(d.dot(x), 2);
    return explained > kLeastOfGain * x.squaredNorm() * d.squaredNorm() && explained > 0.0;
  }

  const ErrorModel& model_;
  const Recording& recording_;
  const std::vector<LabelCluster>& clusters_;
  const Eigen::VectorXd* errors_;
  std::optional<PlacedNominal> placed_;
  std::vector<int> odd_;
  std::vector<double> distance_;
  double far_ = 0.0;
};

}  // namespace

std::vector<OddPostures> FindOddPostures(const ErrorModel& model, const Recording& recording,
                                         const std::vector<LabelCluster>& clusters,
                                         const Eigen::VectorXd* errors) {
  if (!recording.trials.empty() || recording.free_root) return {};
  return OddSearch(model, recording, clusters, errors).Run();
}

}  // namespace elastocal
