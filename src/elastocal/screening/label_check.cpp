// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/label_check.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "elastocal/calibration/nominal_postures.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/math/transform.hpp"
#include "elastocal/screening/exchanged_markers.hpp"

namespace elastocal {
namespace {

constexpr double kLeastDisplaced = 0.05;      // m: two clusters
constexpr double kLeastWrongDistance = 0.01;  // m: two markers
constexpr double kFarNearer = 0.4;            // largest share of the deviation that is left
constexpr std::size_t kMostPostures = 8;      // postures of a trial that are examined

class LabelSuspicionSearch {
 public:
  LabelSuspicionSearch(const ErrorModel& model, const Recording& recording,
                       const std::vector<LabelCluster>& clusters)
      : model_(model), recording_(recording), clusters_(clusters) {}

  std::vector<LabelSuspicion> Run() {
    for (int trial = 0; trial < static_cast<int>(recording_.trials.size()); ++trial) {
      const std::vector<NominalPosture> postures =
          NominalPostures(model_, recording_, trial, kMostPostures);
      for (std::size_t a = 0; a < clusters_.size(); ++a) {
        TryWithin(trial, clusters_[a], postures);
        for (std::size_t b = a + 1; b < clusters_.size(); ++b) {
          TryClusters(trial, clusters_[a], clusters_[b], postures);
        }
      }
    }
    for (LabelSuspicion& one : FindExchangedMarkers(model_, recording_, clusters_)) {
      if (!IsKnown(one)) found_.push_back(std::move(one));
    }
    std::stable_sort(found_.begin(), found_.end(),
                     [](const LabelSuspicion& a, const LabelSuspicion& b) {
                       return a.before - a.after > b.before - b.after;
                     });
    return std::move(found_);
  }

 private:
  bool IsKnown(const LabelSuspicion& one) const {
    return std::any_of(found_.begin(), found_.end(), [&](const LabelSuspicion& known) {
      return known.of_a == one.of_a && known.of_b == one.of_b;
    });
  }

  bool AllSeen(int posture, const std::vector<int>& markers) const {
    return std::all_of(markers.begin(), markers.end(),
                       [&](int m) { return Seen(recording_, posture, m); });
  }

  /// Places the waist by all markers but those of the two clusters, then compares the clusters.
  void TryClusters(int trial, const LabelCluster& a, const LabelCluster& b,
                   const std::vector<NominalPosture>& postures) {
    if (a.markers.size() != b.markers.size()) return;
    double before = 0.0;
    double after = 0.0;
    int count = 0;
    std::vector<int> both = a.markers;
    both.insert(both.end(), b.markers.begin(), b.markers.end());
    for (const NominalPosture& nominal : postures) {
      const bool sees_a = AllSeen(nominal.posture, a.markers);
      const bool sees_b = AllSeen(nominal.posture, b.markers);
      if (!sees_a && !sees_b) continue;
      const auto T_ref_waist = PlaceRoot(recording_, nominal, both);
      if (!T_ref_waist) continue;
      for (std::size_t k = 0; k < a.markers.size(); ++k) {
        const Eigen::Vector3d at_a = *T_ref_waist * nominal.markers.col(a.markers[k]);
        const Eigen::Vector3d at_b = *T_ref_waist * nominal.markers.col(b.markers[k]);
        if (sees_a) {
          const Eigen::Vector3d seen = MarkerPosition(recording_, nominal.posture, a.markers[k]);
          before += (seen - at_a).squaredNorm();
          after += (seen - at_b).squaredNorm();
          ++count;
        }
        if (sees_b) {
          const Eigen::Vector3d seen = MarkerPosition(recording_, nominal.posture, b.markers[k]);
          before += (seen - at_b).squaredNorm();
          after += (seen - at_a).squaredNorm();
          ++count;
        }
      }
    }
    Keep(trial, a, b, count, before, after, kLeastDisplaced);
  }

  /// Medians of the distances within a cluster over the postures; NaN for markers that were never
  /// seen together.
  Eigen::MatrixXd Distances(const LabelCluster& cluster,
                            const std::vector<NominalPosture>& postures) const {
    const auto size = static_cast<Eigen::Index>(cluster.markers.size());
    Eigen::MatrixXd distances = Eigen::MatrixXd::Constant(size, size, std::nan(""));
    for (Eigen::Index i = 0; i < size; ++i) {
      for (Eigen::Index j = 0; j < i; ++j) {
        std::vector<double> found;
        for (const NominalPosture& nominal : postures) {
          if (!AllSeen(nominal.posture, {cluster.markers[i], cluster.markers[j]})) continue;
          found.push_back((MarkerPosition(recording_, nominal.posture, cluster.markers[i]) -
                           MarkerPosition(recording_, nominal.posture, cluster.markers[j]))
                              .norm());
        }
        if (found.empty()) continue;
        distances(i, j) = distances(j, i) = Median(Eigen::Map<const Eigen::VectorXd>(
            found.data(), static_cast<Eigen::Index>(found.size())));
      }
    }
    return distances;
  }

  void TryWithin(int trial, const LabelCluster& cluster,
                 const std::vector<NominalPosture>& postures) {
    const auto size = static_cast<int>(cluster.markers.size());
    if (size < 3 || postures.empty()) return;
    const Eigen::MatrixXd seen = Distances(cluster, postures);
    const Eigen::Matrix3Xd& nominal = postures.front().markers;
    for (int a = 0; a < size; ++a) {
      for (int b = 0; b < a; ++b) {
        double before = 0.0;
        double after = 0.0;
        int count = 0;
        for (int c = 0; c < size; ++c) {
          if (c == a || c == b || !std::isfinite(seen(a, c) + seen(b, c))) continue;
          const auto expected = [&](int from) {
            return (nominal.col(cluster.markers[from]) - nominal.col(cluster.markers[c])).norm();
          };
          before += std::pow(seen(a, c) - expected(a), 2) + std::pow(seen(b, c) - expected(b), 2);
          after += std::pow(seen(a, c) - expected(b), 2) + std::pow(seen(b, c) - expected(a), 2);
          count += 2;
        }
        const LabelCluster of_a{recording_.marker_names[cluster.markers[a]], {cluster.markers[a]}};
        const LabelCluster of_b{recording_.marker_names[cluster.markers[b]], {cluster.markers[b]}};
        Keep(trial, of_b, of_a, count, before, after, kLeastWrongDistance);
      }
    }
  }

  void Keep(int trial, const LabelCluster& a, const LabelCluster& b, int count, double before,
            double after, double least) {
    if (count == 0) return;
    before = std::sqrt(before / count);
    after = std::sqrt(after / count);
    if (before < least || after > kFarNearer * before) return;
    const auto known = std::find_if(found_.begin(), found_.end(), [&](const LabelSuspicion& one) {
      return one.of_a == a.markers && one.of_b == b.markers;
    });
    if (known != found_.end()) {
      known->trials.push_back(trial);
      if (before - after > known->before - known->after) {
        known->before = before;
        known->after = after;
      }
      return;
    }
    found_.push_back({.trials = {trial},
                      .a = a.name,
                      .b = b.name,
                      .of_a = a.markers,
                      .of_b = b.markers,
                      .before = before,
                      .after = after});
  }

  const ErrorModel& model_;
  const Recording& recording_;
  const std::vector<LabelCluster>& clusters_;
  std::vector<LabelSuspicion> found_;
};

/// Whether the labels are exchanged in a posture.
bool IsExchanged(const Recording& recording, const LabelSuspicion& suspicion, int posture) {
  if (!suspicion.postures.empty()) {
    return std::binary_search(suspicion.postures.begin(), suspicion.postures.end(), posture);
  }
  return recording.trials.empty() ||
         std::binary_search(suspicion.trials.begin(), suspicion.trials.end(),
                            recording.trial[posture]);
}

/// The exchanged postures of a trial; empty: all that show both markers.
std::optional<int> ExchangedPart(const Recording& recording, const LabelSuspicion& suspicion,
                                 int trial) {
  int exchanged = 0;
  bool all = true;
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (recording.trial[i] != trial) continue;
    const bool here = IsExchanged(recording, suspicion, i);
    exchanged += here ? 1 : 0;
    all = all && (here || !Seen(recording, i, suspicion.of_a.front()) ||
                  !Seen(recording, i, suspicion.of_b.front()));
  }
  if (all) return std::nullopt;
  return exchanged;
}

}  // namespace

std::vector<LabelSuspicion> FindLabelSuspicions(const ErrorModel& model, const Recording& recording,
                                                const std::vector<LabelCluster>& clusters) {
  return LabelSuspicionSearch(model, recording, clusters).Run();
}

Recording WithoutExchange(const Recording& recording, const LabelSuspicion& suspicion) {
  Recording corrected = recording;
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (!IsExchanged(recording, suspicion, i)) continue;
    for (std::size_t k = 0; k < suspicion.of_a.size(); ++k) {
      corrected.markers.block<1, 3>(i, 3 * suspicion.of_a[k]) =
          recording.markers.block<1, 3>(i, 3 * suspicion.of_b[k]);
      corrected.markers.block<1, 3>(i, 3 * suspicion.of_b[k]) =
          recording.markers.block<1, 3>(i, 3 * suspicion.of_a[k]);
    }
  }
  return corrected;
}

std::string DescribeSuspicion(const LabelSuspicion& suspicion, const Recording& recording) {
  std::string text = "the labels of " + suspicion.a + " and " + suspicion.b + " are exchanged";
  if (!recording.trials.empty()) {
    std::string wholes, parts;
    for (const int trial : suspicion.trials) {
      const std::string& name = recording.trials[trial].name;
      const std::optional<int> part = ExchangedPart(recording, suspicion, trial);
      if (part) {
        parts += (parts.empty() ? "" : ", ") + std::to_string(*part) + " postures of trial " + name;
      } else {
        wholes += (wholes.empty() ? "trial " : ", ") + name;
      }
    }
    return text + " in " + wholes + (wholes.empty() || parts.empty() ? "" : " and in ") + parts;
  }
  if (suspicion.postures.empty()) return text;
  return text + " in " + std::to_string(suspicion.postures.size()) + " postures";
}

}  // namespace elastocal
