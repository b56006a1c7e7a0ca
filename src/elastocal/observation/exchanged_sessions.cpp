// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/exchanged_sessions.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

constexpr double kUnexplained = 9.0;      // squares of a number that the own session leaves
constexpr double kMuchBetter = 0.25;      // of them, that another session leaves
constexpr double kNoiseLeftOver = 0.5;    // of heights, of tilts or of what else is measured
constexpr double kMostShare = 1.0 / 3.0;  // of the postures
constexpr int kMostSessionRounds = 12;

/// By posture the name of its session; empty where nothing in it depends on one.
using Labels = std::vector<std::string>;

/// Effects of sessions by quantity and name.
using EffectsByName = std::map<std::pair<int, std::string>, int>;

EffectsByName NamedEffects(const Observations& observations) {
  EffectsByName effects;
  for (int e = 0; e < static_cast<int>(observations.effects.size()); ++e) {
    const SessionEffect& effect = observations.effects[Size(e)];
    effects[{effect.quantity, effect.name}] = e;
  }
  return effects;
}

/// The observations with the session of each posture; what has none of that name stays.
Observations WithLabels(const Labels& labels, const Observations& observations) {
  const EffectsByName effects = NamedEffects(observations);
  Observations changed = observations;
  for (Observation& of : changed.all) {
    for (int& effect : of.effects) {
      const int quantity = observations.effects[Size(effect)].quantity;
      const auto other = effects.find({quantity, labels[Size(of.posture)]});
      if (other != effects.end()) effect = other->second;
    }
  }
  return changed;
}

Labels LabelsOf(const Observations& observations) {
  Labels labels(observations.postures.size());
  for (const Observation& of : observations.all) {
    if (of.effects.empty()) continue;
    labels[Size(of.posture)] = observations.effects[Size(of.effects.front())].name;
  }
  return labels;
}

class SessionSearch {
 public:
  SessionSearch(const ObservedRobot& model, const Observations& observations)
      : model_(model), observations_(observations), said_(LabelsOf(observations)) {
    for (const SessionEffect& effect : observations.effects) names_.insert(effect.name);
  }

  std::vector<OtherSession> Run() {
    if (names_.size() < 2) return {};
    const ObservationFit start = StartFit(model_, observations_);
    const ObservationFit all = FitObservations(model_, observations_, start, {});
    spread_ = all.spread;
    before_ = NoiseBySource(observations_, all.values);
    Try(all.values);
    if (best_.empty()) {
      Try(FitObservations(model_, observations_, start,
                          {.freedom = {.robot = false}, .robust = true})
              .values);
    }
    return best_;
  }

 private:
  /// By posture: squares of what depends on sessions, a number of it on average.
  std::vector<double> SquaresBy(const Observations& observations, const ObservedValues& at) const {
    const std::vector<Eigen::VectorXd> left = LeftOf(model_, observations, at);
    std::vector<double> squares(said_.size(), 0.0);
    std::vector<int> numbers(said_.size(), 0);
    for (std::size_t i = 0; i < left.size(); ++i) {
      const Observation& of = observations.all[i];
      if (of.effects.empty()) continue;
      const Instrument& instrument = model_.instrument(of.instrument);
      squares[Size(of.posture)] += (instrument.Weights(spread_) * left[i]).squaredNorm();
      numbers[Size(of.posture)] += instrument.size();
    }
    for (std::size_t p = 0; p < squares.size(); ++p) squares[p] /= std::max(1, numbers[p]);
    return squares;
  }

  /// Root mean squares of what depends on sessions, by the source of its noise.
  std::map<int, double> NoiseBySource(const Observations& observations,
                                      const ObservedValues& at) const {
    const std::vector<Eigen::VectorXd> left = LeftOf(model_, observations, at);
    std::map<int, std::pair<double, int>> sums;
    for (std::size_t i = 0; i < left.size(); ++i) {
      if (observations.all[i].effects.empty()) continue;
      const Instrument& instrument = model_.instrument(observations.all[i].instrument);
      for (int row = 0; row < instrument.size(); ++row) {
        auto& [sum, count] = sums[instrument.noise[Size(row)]];
        sum += left[i][row] * left[i][row];
        ++count;
      }
    }
    std::map<int, double> noise;
    for (const auto& [source, of] : sums) noise[source] = std::sqrt(of.first / of.second);
    return noise;
  }

  /// By posture the session that leaves least, where its own leaves much more.
  Labels Nearest(const Labels& labels, const ObservedValues& at, double noise) const {
    const std::vector<double> own = SquaresBy(WithLabels(labels, observations_), at);
    Labels nearest = labels;
    std::vector<double> least = own;
    for (const std::string& name : names_) {
      const Labels one(labels.size(), name);
      const Observations as_of = WithLabels(one, observations_);
      const std::vector<double> squares = SquaresBy(as_of, at);
      for (std::size_t p = 0; p < labels.size(); ++p) {
        if (labels[p].empty() || own[p] < kUnexplained * noise) continue;
        if (squares[p] > kMuchBetter * own[p] || squares[p] >= least[p]) continue;
        least[p] = squares[p];
        nearest[p] = name;
      }
    }
    return nearest;
  }

  void Try(ObservedValues at) {
    Labels labels = said_;
    std::set<Labels> seen;
    double noise = Noise(SquaresBy(observations_, at));
    for (int round = 0; round < kMostSessionRounds && seen.insert(labels).second; ++round) {
      InterruptionPoint();
      Labels next = Nearest(labels, at, noise);
      if (next == labels) break;
      labels = std::move(next);
      const Observations changed = WithLabels(labels, observations_);
      at = FitObservations(model_, changed, StartFit(model_, changed), {}).values;
      noise = Noise(SquaresBy(changed, at));
    }
    Judge(labels, NoiseBySource(WithLabels(labels, observations_), at));
  }

  /// Squares of a number where most postures are of the session that they say.
  static double Noise(const std::vector<double>& squares) {
    std::vector<double> some;
    for (const double of : squares) {
      if (of > 0.0) some.push_back(of);
    }
    return some.empty() ? 1.0 : Median(some);
  }

  void Judge(const Labels& labels, const std::map<int, double>& after) {
    std::vector<OtherSession> others;
    int count = 0;
    for (std::size_t p = 0; p < labels.size(); ++p) {
      if (!said_[p].empty()) ++count;
      if (labels[p] != said_[p]) others.push_back({static_cast<int>(p), said_[p], labels[p]});
    }
    if (static_cast<double>(others.size()) > kMostShare * count) return;
    const bool halved = std::any_of(after.begin(), after.end(), [&](const auto& of) {
      return of.second <= kNoiseLeftOver * before_.at(of.first);
    });
    if (halved) best_ = std::move(others);
  }

  const ObservedRobot& model_;
  const Observations& observations_;
  Labels said_;
  std::set<std::string> names_;
  Spread spread_;
  std::map<int, double> before_;
  std::vector<OtherSession> best_;
};

}  // namespace

std::vector<OtherSession> FindExchangedSessions(const ObservedRobot& model,
                                                const Observations& observations) {
  return SessionSearch(model, observations).Run();
}

Observations InOtherSessions(const std::vector<OtherSession>& postures,
                             const Observations& observations) {
  Labels labels = LabelsOf(observations);
  for (const OtherSession& of : postures) labels[Size(of.posture)] = of.seen;
  return WithLabels(labels, observations);
}

}  // namespace elastocal
