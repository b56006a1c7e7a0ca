// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/table_check.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <utility>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/math/transform.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/robot/linkage.hpp"
#include "elastocal/screening/placed_misfit.hpp"

namespace elastocal {
namespace {

constexpr double kFarFromNominal = 0.02;  // m: beyond errors of a robot and of markers
constexpr double kLeftOfMisfit = 0.6;     // largest share of the misfit that is left
constexpr std::size_t kMostTried = 60;    // postures that are tried, evenly spread
constexpr std::size_t kLeastFrozenRows = 3;
constexpr double kSamePosition = 2e-5;       // rad or m
constexpr double kOtherDistance = 0.01;      // m: difference of distances of two exchanged markers
constexpr double kRightDistance = 0.3;       // largest share of the difference that is left
constexpr double kLeastExchanged = 0.1;      // share of the postures: fewer are outliers
constexpr Eigen::Index kLeastSightings = 3;  // for the pose of the root link

/// Tries mistakes on a table.
class TableSearch {
 public:
  TableSearch(const ErrorModel& model, const Recording& recording)
      : model_(model), recording_(recording) {
    ErrorModel at_origin = model;
    at_origin.T_ref_waist = Transform::Identity();
    geometry_ = ApplyErrors(at_origin, Eigen::VectorXd::Zero(at_origin.parameter_count()));
    for (const int joint : model.active_joints) {
      for (const Drive& drive : DrivesOf(model.tree.joints[Size(joint)])) {
        if (std::find(coordinates_.begin(), coordinates_.end(), drive.coordinate) ==
            coordinates_.end()) {
          coordinates_.push_back(drive.coordinate);
        }
      }
    }
    all_.resize(Size(recording.posture_count()));
    std::iota(all_.begin(), all_.end(), 0);
    thinned_ = SelectPostures(recording, Thinned(all_));
    misfit_ = Misfit(thinned_);
  }

  std::vector<LogSuspicion> Log() {
    std::vector<LogSuspicion> found;
    if (misfit_ > kFarFromNominal) {
      std::vector<int> logged;  // where rods move joints, the motors are logged
      std::copy_if(coordinates_.begin(), coordinates_.end(), std::back_inserter(logged),
                   [&](int c) {
                     return !IsMovedByRods(model_.tree, model_.tree.coordinate_joint[Size(c)]);
                   });
      for (std::size_t a = 0; a < logged.size(); ++a) {
        TryLog({.kind = LogContradiction::kSign, .coordinate = logged[a]}, found);
        for (std::size_t b = a + 1; b < logged.size(); ++b) {
          if (Slides(logged[a]) != Slides(logged[b])) continue;
          TryLog({.kind = LogContradiction::kExchange, .coordinate = logged[a], .other = logged[b]},
                 found);
        }
      }
    }
    for (const int c : coordinates_) TryFrozen(c, found);
    SortByGain(found);
    return found;
  }

  std::vector<LabelSuspicion> Labels(const std::vector<LabelCluster>& clusters) {
    std::vector<LabelSuspicion> found;
    if (misfit_ > kFarFromNominal) {
      for (std::size_t a = 0; a < clusters.size(); ++a) {
        for (std::size_t b = a + 1; b < clusters.size(); ++b) {
          if (clusters[a].markers.size() != clusters[b].markers.size()) continue;
          TryLabels(clusters[a], clusters[b], found);
        }
      }
      for (int a = 0; a < recording_.marker_count(); ++a) {
        for (int b = a + 1; b < recording_.marker_count(); ++b) {
          TryLabels({recording_.marker_names[Size(a)], {a}},
                    {recording_.marker_names[Size(b)], {b}}, found);
        }
      }
    }
    for (const LabelCluster& cluster : clusters) TryWithin(cluster, found);
    SortByGain(found);
    return found;
  }

 private:
  template <typename Suspicion>
  static void SortByGain(std::vector<Suspicion>& found) {
    std::stable_sort(found.begin(), found.end(), [](const Suspicion& a, const Suspicion& b) {
      return a.before - a.after > b.before - b.after;
    });
  }

  static std::vector<int> Thinned(const std::vector<int>& postures) {
    std::vector<int> kept;
    const std::size_t stride = 1 + postures.size() / kMostTried;
    for (std::size_t i = 0; i < postures.size(); i += stride) kept.push_back(postures[i]);
    return kept;
  }

  bool Slides(int coordinate) const {
    const RobotTree& tree = model_.tree;
    return tree.joints[Size(tree.coordinate_joint[Size(coordinate)])].type == JointType::kPrismatic;
  }

  /// Nominal markers in the root link's frame, and the measured ones, for all that was seen.
  struct Sightings {
    Eigen::Matrix3Xd nominal, measured;
    std::vector<int> marker;
  };

  Sightings SightingsOf(const Recording& recording, const std::vector<int>& postures) {
    Sightings sightings;
    const Eigen::Index most = recording.marker_count() * static_cast<Eigen::Index>(postures.size());
    sightings.nominal.resize(3, most);
    sightings.measured.resize(3, most);
    for (const int i : postures) {
      const Eigen::Matrix3Xd nominal =
          MarkerPositions(model_, geometry_, recording.q.row(i).transpose());
      for (int m = 0; m < recording.marker_count(); ++m) {
        if (!Seen(recording, i, m)) continue;
        const auto k = static_cast<Eigen::Index>(sightings.marker.size());
        sightings.nominal.col(k) = nominal.col(m);
        sightings.measured.col(k) = MarkerPosition(recording, i, m);
        sightings.marker.push_back(m);
      }
    }
    const auto count = static_cast<Eigen::Index>(sightings.marker.size());
    sightings.nominal.conservativeResize(3, count);
    sightings.measured.conservativeResize(3, count);
    return sightings;
  }

  static std::optional<Transform> PlaceOf(const Sightings& sightings) {
    if (sightings.nominal.cols() < kLeastSightings) return std::nullopt;
    return FitRigid(sightings.nominal, sightings.measured);
  }

  /// Distances of the measured markers from the nominal ones, by marker, m.
  using Distances = std::vector<std::vector<double>>;

  void AddDistances(const Sightings& sightings, const Transform& T_ref_root,
                    Distances& distances) const {
    distances.resize(Size(recording_.marker_count()));
    const Eigen::Matrix3Xd off = T_ref_root * sightings.nominal - sightings.measured;
    for (Eigen::Index k = 0; k < off.cols(); ++k) {
      distances[Size(sightings.marker[Size(k)])].push_back(off.col(k).norm());
    }
  }

  /// Typical distance of the markers from the nominal robot with the root link placed best, m.
  double Misfit(const Recording& recording) {
    std::vector<int> all(Size(recording.posture_count()));
    std::iota(all.begin(), all.end(), 0);
    std::vector<std::vector<int>> placed = {all};
    if (recording.free_root) {
      placed.clear();
      for (const int i : all) placed.push_back({i});
    }
    Distances distances;
    for (const std::vector<int>& together : placed) {
      const Sightings sightings = SightingsOf(recording, together);
      if (const auto T_ref_root = PlaceOf(sightings)) {
        AddDistances(sightings, *T_ref_root, distances);
      }
    }
    return TypicalDistance(distances);
  }

  void TryLog(LogSuspicion suspicion, std::vector<LogSuspicion>& found) {
    suspicion.postures.resize(Size(thinned_.posture_count()));
    std::iota(suspicion.postures.begin(), suspicion.postures.end(), 0);
    suspicion.before = misfit_;
    suspicion.after = Misfit(WithoutMistake(thinned_, suspicion, model_.tree));
    suspicion.postures = all_;
    if (suspicion.after <= kLeftOfMisfit * misfit_) found.push_back(std::move(suspicion));
  }

  void TryLabels(const LabelCluster& a, const LabelCluster& b, std::vector<LabelSuspicion>& found) {
    LabelSuspicion suspicion{.a = a.name, .b = b.name, .of_a = a.markers, .of_b = b.markers};
    suspicion.before = misfit_;
    suspicion.after = Misfit(WithoutExchange(thinned_, suspicion));
    if (suspicion.after <= kLeftOfMisfit * misfit_) found.push_back(std::move(suspicion));
  }

  void TryFrozen(int c, std::vector<LogSuspicion>& found) {
    if (recording_.free_root) return;  // each posture has a pose of its own
    std::vector<int> run, longest;
    for (const int i : all_) {
      if (!run.empty() &&
          std::abs(recording_.q(i, c) - recording_.q(run.front(), c)) > kSamePosition) {
        run.clear();
      }
      run.push_back(i);
      if (run.size() > longest.size()) longest = run;
    }
    if (longest.size() < kLeastFrozenRows || longest.size() == all_.size()) return;
    std::vector<int> others;
    std::set_difference(all_.begin(), all_.end(), longest.begin(), longest.end(),
                        std::back_inserter(others));
    const Sightings elsewhere = SightingsOf(recording_, Thinned(others));
    const auto T_ref_root = PlaceOf(elsewhere);
    if (!T_ref_root) return;
    Distances frozen, moving;
    AddDistances(SightingsOf(recording_, Thinned(longest)), *T_ref_root, frozen);
    AddDistances(elsewhere, *T_ref_root, moving);
    LogSuspicion suspicion{.kind = LogContradiction::kFrozen, .coordinate = c, .postures = longest};
    suspicion.before = TypicalDistance(frozen);
    suspicion.after = TypicalDistance(moving);
    if (suspicion.before > kFarFromNominal && suspicion.after <= kLeftOfMisfit * suspicion.before) {
      found.push_back(std::move(suspicion));
    }
  }

  double Distance(int i, int m, int n) const {
    return (MarkerPosition(recording_, i, m) - MarkerPosition(recording_, i, n)).norm();
  }

  /// Medians of the distances within a cluster over the postures; NaN for markers that were never
  /// seen together.
  Eigen::MatrixXd UsualDistances(const std::vector<int>& markers) const {
    const auto size = static_cast<Eigen::Index>(markers.size());
    Eigen::MatrixXd usual = Eigen::MatrixXd::Constant(size, size, std::nan(""));
    for (Eigen::Index a = 0; a < size; ++a) {
      for (Eigen::Index b = 0; b < a; ++b) {
        std::vector<double> seen;
        for (const int i : all_) {
          const int m = markers[Size(a)], n = markers[Size(b)];
          if (Seen(recording_, i, m) && Seen(recording_, i, n)) seen.push_back(Distance(i, m, n));
        }
        if (!seen.empty()) usual(a, b) = usual(b, a) = Median(seen);
      }
    }
    return usual;
  }

  /// Finds exchanges within a cluster in a tenth to half of the postures.
  void TryWithin(const LabelCluster& cluster, std::vector<LabelSuspicion>& found) {
    const Eigen::MatrixXd usual = UsualDistances(cluster.markers);
    for (Eigen::Index a = 0; a < usual.rows(); ++a) {
      for (Eigen::Index b = a + 1; b < usual.rows(); ++b) {
        const int of_a = cluster.markers[Size(a)], of_b = cluster.markers[Size(b)];
        LabelSuspicion suspicion{.a = recording_.marker_names[Size(of_a)],
                                 .b = recording_.marker_names[Size(of_b)],
                                 .of_a = {of_a},
                                 .of_b = {of_b}};
        double before = 0.0, after = 0.0;
        for (const int i : all_) {
          const auto [wrong, undone] = DistancesOff(i, cluster.markers, usual, a, b);
          if (!(wrong > kOtherDistance) || undone > kRightDistance * wrong) continue;
          suspicion.postures.push_back(i);
          before += wrong * wrong;
          after += undone * undone;
        }
        const auto share =
            static_cast<double>(suspicion.postures.size()) / static_cast<double>(all_.size());
        if (share < kLeastExchanged || share > 0.5) continue;
        suspicion.before = std::sqrt(before / static_cast<double>(all_.size()));
        suspicion.after = std::sqrt(after / static_cast<double>(all_.size()));
        found.push_back(std::move(suspicion));
      }
    }
  }

  /// Deviation of the distances of two markers to the others of their cluster in a posture, rms, m:
  /// as labelled, and with the two exchanged. 0 where none is seen.
  std::pair<double, double> DistancesOff(int i, const std::vector<int>& markers,
                                         const Eigen::MatrixXd& usual, Eigen::Index a,
                                         Eigen::Index b) const {
    const int of_a = markers[Size(a)], of_b = markers[Size(b)];
    if (!Seen(recording_, i, of_a) || !Seen(recording_, i, of_b)) return {0.0, 0.0};
    double before = 0.0, after = 0.0;
    int count = 0;
    for (Eigen::Index c = 0; c < usual.rows(); ++c) {
      if (c == a || c == b || !Seen(recording_, i, markers[Size(c)])) continue;
      const double to_a = Distance(i, of_a, markers[Size(c)]);
      const double to_b = Distance(i, of_b, markers[Size(c)]);
      before += std::pow(to_a - usual(a, c), 2) + std::pow(to_b - usual(b, c), 2);
      after += std::pow(to_a - usual(b, c), 2) + std::pow(to_b - usual(a, c), 2);
      count += 2;
    }
    if (count == 0) return {0.0, 0.0};
    return {std::sqrt(before / count), std::sqrt(after / count)};
  }

  const ErrorModel& model_;
  const Recording& recording_;
  Geometry geometry_;
  std::vector<int> coordinates_;  ///< coordinates that move a marker
  std::vector<int> all_;          ///< all postures
  Recording thinned_;             ///< some of them
  double misfit_ = 0.0;           ///< misfit of the table as it is, m
};

}  // namespace

TableSuspicions FindTableSuspicions(const ErrorModel& model, const Recording& recording,
                                    const std::vector<LabelCluster>& clusters) {
  if (!recording.trials.empty()) return {};
  TableSearch search(model, recording);
  return {search.Log(), search.Labels(clusters)};
}

}  // namespace elastocal
