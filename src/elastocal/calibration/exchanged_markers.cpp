// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/exchanged_markers.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "elastocal/calibration/nominal_postures.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

constexpr double kLeastMisplaced = 0.01;  // m: rms of the two
constexpr double kLeftByExchange = 0.4;   // of what was wrong, at most
constexpr std::size_t kLookedAt = 8;      // postures of a trial, before all of them

/// Squared distances of a cluster's markers from where they should be, m^2: as they are labelled,
/// and with two of them exchanged.
struct Misplaced {
  double before = 0.0;
  double after = 0.0;

  bool ByExchange() const {
    return before >= 2.0 * kLeastMisplaced * kLeastMisplaced &&
           after <= kLeftByExchange * kLeftByExchange * before;
  }
};

/// What postures show of two markers.
struct Sightings {
  int telling = 0;             // postures that show both and the rest of the robot
  int wrong = 0;               // of these, the ones that are exchanged
  std::vector<int> exchanged;  // all that are taken for it
  std::vector<int> trials;     // with such postures
  Misplaced misplaced;         // in those that are wrong
};

/// A cluster in some postures, as it is seen and as the nominal robot turns it.
class ClusterInPostures {
 public:
  ClusterInPostures(const Recording& recording, const LabelCluster& cluster,
                    const std::vector<NominalPosture>& postures)
      : recording_(recording), cluster_(cluster), postures_(postures) {
    for (const NominalPosture& nominal : postures) {
      roots_.push_back(PlaceRoot(recording, nominal, cluster.markers));
    }
  }

  /// A posture that does not tell is taken for what the one before it is.
  Sightings Of(int a, int b) const {
    Sightings sightings;
    bool exchanged = false;
    for (std::size_t i = 0; i < postures_.size(); ++i) {
      const std::optional<Misplaced> misplaced = MisplacedIn(i, a, b);
      if (misplaced) {
        exchanged = misplaced->ByExchange();
        ++sightings.telling;
      }
      if (!exchanged) continue;
      sightings.exchanged.push_back(postures_[i].posture);
      if (!misplaced) continue;
      ++sightings.wrong;
      sightings.misplaced.before += misplaced->before;
      sightings.misplaced.after += misplaced->after;
    }
    return sightings;
  }

 private:
  /// Markers from the mean of their cluster: where that is does not matter.
  std::optional<Misplaced> MisplacedIn(std::size_t i, int a, int b) const {
    const int posture = postures_[i].posture;
    if (!roots_[i] || !Seen(recording_, posture, a) || !Seen(recording_, posture, b)) {
      return std::nullopt;
    }
    std::vector<int> seen;
    std::copy_if(cluster_.markers.begin(), cluster_.markers.end(), std::back_inserter(seen),
                 [&](int m) { return Seen(recording_, posture, m); });
    Eigen::Matrix3Xd is(3, std::ssize(seen)), should(3, std::ssize(seen));
    for (Eigen::Index k = 0; k < is.cols(); ++k) {
      is.col(k) = MarkerPosition(recording_, posture, seen[Size(k)]);
      should.col(k) = *roots_[i] * postures_[i].markers.col(seen[Size(k)]);
    }
    is.colwise() -= is.rowwise().mean().eval();
    should.colwise() -= should.rowwise().mean().eval();
    Misplaced misplaced{.before = (is - should).squaredNorm()};
    const auto at = [&](int m) { return std::find(seen.begin(), seen.end(), m) - seen.begin(); };
    is.col(at(a)).swap(is.col(at(b)));
    misplaced.after = (is - should).squaredNorm();
    return misplaced;
  }

  const Recording& recording_;
  const LabelCluster& cluster_;
  const std::vector<NominalPosture>& postures_;
  std::vector<std::optional<Transform>> roots_;
};

/// Looks at a few postures of each trial first, and at all of one where there is a suspicion.
class ExchangeSearch {
 public:
  ExchangeSearch(const ErrorModel& model, const Recording& recording)
      : model_(model), recording_(recording) {
    for (int trial = 0; trial < static_cast<int>(recording.trials.size()); ++trial) {
      few_.push_back(NominalPostures(model, recording, trial, kLookedAt));
    }
    all_.resize(few_.size());
  }

  std::vector<LabelSuspicion> Within(const LabelCluster& cluster) {
    std::vector<ClusterInPostures> by_trial;
    for (const auto& postures : few_) by_trial.emplace_back(recording_, cluster, postures);
    std::vector<LabelSuspicion> suspicions;
    for (std::size_t i = 0; i < cluster.markers.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const int a = cluster.markers[j], b = cluster.markers[i];
        Sightings of;
        for (std::size_t trial = 0; trial < by_trial.size(); ++trial) {
          Sightings here = by_trial[trial].Of(a, b);
          if (here.wrong > 0) {
            here = ClusterInPostures(recording_, cluster, AllOf(trial)).Of(a, b);
            here.trials = {static_cast<int>(trial)};
          }
          Add(here, of);
        }
        if (of.wrong > 0 && of.wrong < of.telling) suspicions.push_back(Suspicion(a, b, of));
      }
    }
    return suspicions;
  }

 private:
  const std::vector<NominalPosture>& AllOf(std::size_t trial) {
    if (all_[trial].empty()) {
      all_[trial] = NominalPostures(model_, recording_, static_cast<int>(trial),
                                    Size(recording_.posture_count()) + 1);
    }
    return all_[trial];
  }

  static void Add(const Sightings& more, Sightings& of) {
    of.telling += more.telling;
    of.wrong += more.wrong;
    of.exchanged.insert(of.exchanged.end(), more.exchanged.begin(), more.exchanged.end());
    of.trials.insert(of.trials.end(), more.trials.begin(), more.trials.end());
    of.misplaced.before += more.misplaced.before;
    of.misplaced.after += more.misplaced.after;
  }

  LabelSuspicion Suspicion(int a, int b, Sightings of) const {
    std::sort(of.exchanged.begin(), of.exchanged.end());
    return {.trials = of.trials,
            .postures = of.exchanged,
            .a = recording_.marker_names[Size(a)],
            .b = recording_.marker_names[Size(b)],
            .of_a = {a},
            .of_b = {b},
            .before = std::sqrt(of.misplaced.before / (2.0 * of.wrong)),
            .after = std::sqrt(of.misplaced.after / (2.0 * of.wrong))};
  }

  const ErrorModel& model_;
  const Recording& recording_;
  std::vector<std::vector<NominalPosture>> few_, all_;  // by trial
};

}  // namespace

std::vector<LabelSuspicion> FindExchangedMarkers(const ErrorModel& model,
                                                 const Recording& recording,
                                                 const std::vector<LabelCluster>& clusters) {
  ExchangeSearch search(model, recording);
  std::vector<LabelSuspicion> suspicions;
  for (const LabelCluster& cluster : clusters) {
    for (LabelSuspicion& one : search.Within(cluster)) suspicions.push_back(std::move(one));
  }
  return suspicions;
}

}  // namespace elastocal
