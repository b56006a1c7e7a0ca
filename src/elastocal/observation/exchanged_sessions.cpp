// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/exchanged_sessions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
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
// Of two sessions whose postures are mixed: as many as half of them. Noise that is cut in two
// leaves 0.6 of itself (0.36 of its squares), so less than a half of that is asked for.
constexpr double kMostOfMixed = 0.5, kNoiseLeftOfMixed = 0.3, kCutInTwo = 0.15;
constexpr std::size_t kFewestToCut = 8;
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

/// Numbers cut in two at the place that leaves least squares about the means of the parts.
struct Cut {
  double at = 0.0;     ///< the largest number of the lower part
  double share = 1.0;  ///< of the squares about the mean of all, that is left
};

Cut CutInTwo(std::vector<double> numbers) {
  std::sort(numbers.begin(), numbers.end());
  const auto count = static_cast<double>(numbers.size());
  double sum = 0.0, squares = 0.0;
  for (const double of : numbers) {
    sum += of;
    squares += of * of;
  }
  const double all = squares - sum * sum / count;
  Cut best;
  if (!(all > 0.0)) return best;
  double below = 0.0;
  for (std::size_t n = 1; n < numbers.size(); ++n) {
    below += numbers[n - 1];
    const double first = static_cast<double>(n), above = sum - below;
    const double left = squares - below * below / first - above * above / (count - first);
    if (left / all < best.share) best = {numbers[n - 1], left / all};
  }
  return best;
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
    Try(said_, all.values, kMostShare, kNoiseLeftOver);
    if (best_.empty()) {
      Try(said_,
          FitObservations(model_, observations_, start,
                          {.freedom = {.robot = false}, .robust = true})
              .values,
          kMostShare, kNoiseLeftOver);
    }
    if (best_.empty()) TryMixed(all.values);
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

  /// Each two sessions as if their postures were mixed: what lies in two heaps, whatever the
  /// postures say, is of one session and of the other.
  void TryMixed(const ObservedValues& at) {
    for (auto a = names_.begin(); a != names_.end(); ++a) {
      for (auto b = std::next(a); b != names_.end(); ++b) {
        const Labels labels = InTwoHeaps(*a, *b, at);
        if (labels == said_ || !best_.empty()) continue;
        const Observations changed = WithLabels(labels, observations_);
        Try(labels, FitObservations(model_, changed, StartFit(model_, changed), {}).values,
            kMostOfMixed, kNoiseLeftOfMixed);
      }
    }
  }

  /// By instrument, the two heaps as like the labels as may be; as said where there are none.
  Labels InTwoHeaps(const std::string& a, const std::string& b, const ObservedValues& at) const {
    Labels labels = said_, as_of_a = said_;
    std::replace(as_of_a.begin(), as_of_a.end(), b, a);
    const std::vector<Eigen::VectorXd> left =
        LeftOf(model_, WithLabels(as_of_a, observations_), at);
    std::map<int, std::vector<int>> by_instrument;
    for (int i = 0; i < observations_.count(); ++i) {
      const Observation& of = observations_.all[Size(i)];
      const std::string& said = said_[Size(of.posture)];
      if (!of.effects.empty() && (said == a || said == b))
        by_instrument[of.instrument].push_back(i);
    }
    for (const auto& [instrument, all] : by_instrument) {
      if (all.size() < kFewestToCut) continue;
      Cut best{0.0, kCutInTwo};
      int best_row = -1;
      for (int row = 0; row < model_.instrument(instrument).size(); ++row) {
        std::vector<double> numbers;
        for (const int i : all) numbers.push_back(left[Size(i)][row]);
        const Cut cut = CutInTwo(numbers);
        if (!(cut.share < best.share)) continue;
        best = cut;
        best_row = row;
      }
      if (best_row >= 0) Label(all, left, best_row, best.at, {a, b}, labels);
    }
    return labels;
  }

  /// Where the heaps are as large as the sessions: rows that were exchanged are still as many, and
  /// touches in the air are not.
  void Label(const std::vector<int>& all, const std::vector<Eigen::VectorXd>& left, int row,
             double at, const std::pair<std::string, std::string>& names, Labels& labels) const {
    constexpr double kAsMany = 0.15;  // of all
    const auto below = [&](int i) { return left[Size(i)][row] <= at; };
    const auto of_first = [&](int i) {
      return said_[Size(observations_.all[Size(i)].posture)] == names.first;
    };
    const auto agree =
        std::count_if(all.begin(), all.end(), [&](int i) { return below(i) == of_first(i); });
    const bool first_is_below = 2 * agree >= std::ssize(all);
    const auto before = std::count_if(all.begin(), all.end(), of_first);
    const auto after =
        std::count_if(all.begin(), all.end(), [&](int i) { return below(i) == first_is_below; });
    const auto change = static_cast<double>(std::abs(after - before));
    if (change > kAsMany * static_cast<double>(all.size())) return;
    for (const int i : all) {
      labels[Size(observations_.all[Size(i)].posture)] =
          below(i) == first_is_below ? names.first : names.second;
    }
  }

  /// From these labels on; taken if at most this share of the postures has another one than it
  /// says, and less than this share of the noise is left.
  void Try(Labels labels, ObservedValues at, double most_share, double noise_left) {
    std::set<Labels> seen;
    double noise = Noise(SquaresBy(WithLabels(labels, observations_), at));
    for (int round = 0; round < kMostSessionRounds && seen.insert(labels).second; ++round) {
      InterruptionPoint();
      Labels next = Nearest(labels, at, noise);
      if (next == labels) break;
      labels = std::move(next);
      const Observations changed = WithLabels(labels, observations_);
      at = FitObservations(model_, changed, StartFit(model_, changed), {}).values;
      noise = Noise(SquaresBy(changed, at));
    }
    const auto after = NoiseBySource(WithLabels(labels, observations_), at);
    const bool less = std::any_of(after.begin(), after.end(), [&](const auto& of) {
      return of.second <= noise_left * before_.at(of.first);
    });
    if (less) Take(labels, most_share);
  }

  /// Squares of a number where most postures are of the session that they say.
  static double Noise(const std::vector<double>& squares) {
    std::vector<double> some;
    for (const double of : squares) {
      if (of > 0.0) some.push_back(of);
    }
    return some.empty() ? 1.0 : Median(some);
  }

  void Take(const Labels& labels, double most_share) {
    std::vector<OtherSession> others;
    int count = 0;
    for (std::size_t p = 0; p < labels.size(); ++p) {
      if (!said_[p].empty()) ++count;
      if (labels[p] != said_[p]) others.push_back({static_cast<int>(p), said_[p], labels[p]});
    }
    if (static_cast<double>(others.size()) <= most_share * count) best_ = std::move(others);
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
