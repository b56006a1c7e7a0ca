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

// Mean square of a number, in units of the noise, that its own session leaves.
constexpr double kUnexplained = 9.0;
constexpr double kMuchBetter = 0.25;  // ratio of the squares that another session leaves to these
// Ratio of the noise of heights, of tilts or of another measured quantity.
constexpr double kNoiseLeftOver = 0.5;
constexpr double kMostShare = 1.0 / 3.0;  // share of the postures
// For two sessions whose postures are mixed, as many as half of them. Cutting pure noise in two
// leaves 0.6 of it (0.36 of its squares), so that less than half of that is required.
constexpr double kMostOfMixed = 0.5, kNoiseLeftOfMixed = 0.3, kCutInTwo = 0.15;
constexpr std::size_t kFewestToCut = 8;
constexpr int kMostSessionRounds = 12;

/// Name of the session of each posture; empty where nothing in it depends on a session.
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

/// The observations with the given session in each posture; observations without an effect of that
/// name keep theirs.
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

/// A division of numbers into two parts that leaves the smallest squares about the means of the
/// parts.
struct Cut {
  double at = 0.0;     ///< the largest number of the lower part
  double share = 1.0;  ///< share of the squares about the common mean that is left
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
  /// For each posture: mean square of the numbers that depend on sessions.
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

  /// Root mean square of the numbers that depend on sessions, by the source of their noise.
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

  /// For each posture: the session with the smallest squares, where its own has much larger ones.
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

  /// Treats each two sessions as if their postures were mixed: observations that form two heaps are
  /// assigned by heap, whatever the rows say.
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

  /// For each instrument: the two heaps, named so that they agree best with the rows; as stated
  /// where there are no heaps.
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

  /// Applies the heaps only if they are about as large as the sessions. Exchanging rows does not
  /// change these numbers; touches in the air do.
  void Label(const std::vector<int>& all, const std::vector<Eigen::VectorXd>& left, int row,
             double at, const std::pair<std::string, std::string>& names, Labels& labels) const {
    constexpr double kAsMany = 0.15;  // share of all
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

  /// Starts from these labels. The result is taken if at most `most_share` of the postures have
  /// another session than stated, and at most `noise_left` of the noise is left.
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

  /// Typical mean square of a number, where most postures have the right session: the median.
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
