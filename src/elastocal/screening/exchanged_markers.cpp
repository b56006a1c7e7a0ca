// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/exchanged_markers.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "elastocal/calibration/nominal_postures.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

constexpr double kLeastWithin = 0.01;      // m: rms distance of two markers of one cluster
constexpr double kLeastBetween = 0.05;     // m: the same for two clusters
constexpr double kLeftByExchange = 0.4;    // largest share of the distance that an exchange leaves
constexpr double kLeftAtFirstSight = 0.7;  // the same where the two help to place the root link
constexpr std::size_t kLookedAt = 8;  // postures of a trial that are examined before all of them

/// Two markers of the recording, and the indices of their clusters.
struct MarkerPair {
  int a = -1, b = -1;
  std::size_t cluster_a = 0, cluster_b = 0;

  double least() const { return cluster_a == cluster_b ? kLeastWithin : kLeastBetween; }
};

/// Squared distances of two markers from their expected positions, m^2: as labelled, and with the
/// labels exchanged.
struct Misplaced {
  double before = 0.0;
  double after = 0.0;

  bool ByExchange(double least, double left) const {
    return before >= 2.0 * least * least && after <= left * left * before;
  }
};

/// Positions of all markers in one posture, m (3 x markers); NaN: not seen.
struct PlacedPosture {
  NominalPosture nominal;
  Eigen::Matrix3Xd is, should;
};

/// Evidence about a pair in some postures.
struct Sightings {
  int telling = 0;             // postures that show both and the rest of the robot
  int wrong = 0;               // of these: exchanged ones
  std::vector<int> exchanged;  // all postures that count as exchanged
  std::vector<int> trials;     // trials with such postures
  Misplaced misplaced;         // sums over the postures in `wrong`

  void Add(const Sightings& more) {
    telling += more.telling;
    wrong += more.wrong;
    exchanged.insert(exchanged.end(), more.exchanged.begin(), more.exchanged.end());
    trials.insert(trials.end(), more.trials.begin(), more.trials.end());
    misplaced.before += more.misplaced.before;
    misplaced.after += more.misplaced.after;
  }
};

class ExchangeSearch {
 public:
  ExchangeSearch(const ErrorModel& model, const Recording& recording,
                 const std::vector<LabelCluster>& clusters)
      : model_(model), recording_(recording), clusters_(clusters) {
    for (int trial = 0; trial < static_cast<int>(recording.trials.size()); ++trial) {
      few_.push_back(Placed(NominalPostures(model, recording, trial, kLookedAt)));
    }
    all_.resize(few_.size());
  }

  /// Examines a few postures of each trial, and all postures of a trial where there is a suspicion.
  Sightings Of(const MarkerPair& pair) {
    Sightings sightings;
    for (std::size_t trial = 0; trial < few_.size(); ++trial) {
      Sightings here = In(few_[trial], pair);
      if (here.wrong > 0) {
        here = In(AllOf(trial), pair);
        here.trials = {static_cast<int>(trial)};
      }
      sightings.Add(here);
    }
    std::sort(sightings.exchanged.begin(), sightings.exchanged.end());
    return sightings;
  }

 private:
  std::vector<PlacedPosture> Placed(const std::vector<NominalPosture>& postures) const {
    std::vector<PlacedPosture> placed;
    for (const NominalPosture& nominal : postures) {
      if (auto one = Place(nominal, {})) placed.push_back(std::move(*one));
    }
    return placed;
  }

  const std::vector<PlacedPosture>& AllOf(std::size_t trial) {
    if (all_[trial].empty()) {
      all_[trial] = Placed(NominalPostures(model_, recording_, static_cast<int>(trial),
                                           Size(recording_.posture_count()) + 1));
    }
    return all_[trial];
  }

  std::optional<PlacedPosture> Place(const NominalPosture& nominal,
                                     const std::vector<int>& without) const {
    const auto T_ref_root = PlaceRoot(recording_, nominal, without);
    if (!T_ref_root) return std::nullopt;
    PlacedPosture placed{nominal, nominal.markers, nominal.markers};
    for (int m = 0; m < recording_.marker_count(); ++m) {
      placed.is.col(m) = MarkerPosition(recording_, nominal.posture, m);
      placed.should.col(m) = *T_ref_root * nominal.markers.col(m);
    }
    return placed;
  }

  /// A posture that shows nothing counts like the one before it.
  Sightings In(const std::vector<PlacedPosture>& postures, const MarkerPair& pair) const {
    Sightings sightings;
    bool exchanged = false;
    for (const PlacedPosture& placed : postures) {
      const std::optional<Misplaced> misplaced = Look(placed, pair);
      if (misplaced) {
        exchanged = misplaced->ByExchange(pair.least(), kLeftByExchange);
        ++sightings.telling;
      }
      if (!exchanged) continue;
      sightings.exchanged.push_back(placed.nominal.posture);
      if (!misplaced) continue;
      ++sightings.wrong;
      sightings.misplaced.before += misplaced->before;
      sightings.misplaced.after += misplaced->after;
    }
    return sightings;
  }

  /// Places the root link first by all markers, then without those that may be wrong.
  std::optional<Misplaced> Look(const PlacedPosture& placed, const MarkerPair& pair) const {
    const std::optional<Misplaced> roughly = MisplacedIn(placed, pair);
    if (!roughly || !roughly->ByExchange(kLeftAtFirstSight * pair.least(), kLeftAtFirstSight)) {
      return roughly;
    }
    std::vector<int> without = clusters_[pair.cluster_a].markers;
    const std::vector<int>& more = clusters_[pair.cluster_b].markers;
    without.insert(without.end(), more.begin(), more.end());
    const auto anew = Place(placed.nominal, without);
    return anew ? MisplacedIn(*anew, pair) : std::nullopt;
  }

  /// Distances relative to the other markers of their clusters, so that errors of the nominal robot
  /// do not count.
  std::optional<Misplaced> MisplacedIn(const PlacedPosture& placed, const MarkerPair& pair) const {
    const Eigen::Vector3d a = placed.is.col(pair.a), b = placed.is.col(pair.b);
    if (!a.allFinite() || !b.allFinite()) return std::nullopt;
    const Eigen::Vector3d at_a =
        placed.should.col(pair.a) + OffOthers(placed, pair.cluster_a, pair);
    const Eigen::Vector3d at_b =
        placed.should.col(pair.b) + OffOthers(placed, pair.cluster_b, pair);
    return Misplaced{(a - at_a).squaredNorm() + (b - at_b).squaredNorm(),
                     (a - at_b).squaredNorm() + (b - at_a).squaredNorm()};
  }

  /// Mean displacement of the other markers of a cluster, m.
  Eigen::Vector3d OffOthers(const PlacedPosture& placed, std::size_t cluster,
                            const MarkerPair& pair) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int count = 0;
    for (const int m : clusters_[cluster].markers) {
      if (m == pair.a || m == pair.b || !placed.is.col(m).allFinite()) continue;
      sum += placed.is.col(m) - placed.should.col(m);
      ++count;
    }
    return sum / std::max(1, count);
  }

  const ErrorModel& model_;
  const Recording& recording_;
  const std::vector<LabelCluster>& clusters_;
  std::vector<std::vector<PlacedPosture>> few_, all_;  // by trial
};

std::vector<MarkerPair> AllPairs(const std::vector<LabelCluster>& clusters) {
  std::vector<MarkerPair> pairs;
  for (std::size_t j = 0; j < clusters.size(); ++j) {
    for (std::size_t i = 0; i <= j; ++i) {
      for (const int b : clusters[j].markers) {
        for (const int a : clusters[i].markers) {
          if (i != j || a < b) pairs.push_back({a, b, i, j});
        }
      }
    }
  }
  return pairs;
}

}  // namespace

std::vector<LabelSuspicion> FindExchangedMarkers(const ErrorModel& model,
                                                 const Recording& recording,
                                                 const std::vector<LabelCluster>& clusters) {
  const auto body_of = [&](int m) {
    return model.tree.links[Size(model.markers[Size(m)].link)].body;
  };
  ExchangeSearch search(model, recording, clusters);
  std::vector<LabelSuspicion> suspicions;
  for (const MarkerPair& pair : AllPairs(clusters)) {
    const Sightings of = search.Of(pair);
    // On one body it does no harm, because the places of markers are estimated.
    const bool everywhere = of.wrong == of.telling;
    if (of.wrong == 0 || (everywhere && body_of(pair.a) == body_of(pair.b))) continue;
    suspicions.push_back({.trials = of.trials,
                          .postures = of.exchanged,
                          .a = recording.marker_names[Size(pair.a)],
                          .b = recording.marker_names[Size(pair.b)],
                          .of_a = {pair.a},
                          .of_b = {pair.b},
                          .before = std::sqrt(of.misplaced.before / (2.0 * of.wrong)),
                          .after = std::sqrt(of.misplaced.after / (2.0 * of.wrong))});
  }
  return suspicions;
}

}  // namespace elastocal
