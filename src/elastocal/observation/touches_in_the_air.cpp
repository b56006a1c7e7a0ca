// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/touches_in_the_air.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "elastocal/calibration/posterior.hpp"
#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/optim/normal_equations.hpp"

namespace elastocal {
namespace {

constexpr double kExplained = 3.5;  // standard deviations of a prediction
constexpr double kHighAbove = 5.0;  // in units of the noise: median height of those in the air
constexpr double kNoiseLeft = 0.5;  // ratio to the noise with all touches
constexpr double kNoiseThatMatters =
    1e-3;  // m, with all touches: below, none is high enough to matter
constexpr double kFewestShare = 1.0 / 3.0;  // share of the touches that lie on the tables
constexpr int kFewestTouchesTold = 8;
constexpr int kMostRounds = 12;
constexpr double kStartShares[] = {0.5, 0.3};  // share of a plate's touches, closest together

/// Indices of the observations that are touches.
std::vector<int> TouchesAmong(const ObservedRobot& model, const Observations& observations) {
  std::vector<int> touches;
  for (int i = 0; i < observations.count(); ++i) {
    if (model.IsPlate(observations.all[Size(i)].instrument)) touches.push_back(i);
  }
  return touches;
}

class AirSearch {
 public:
  AirSearch(const ObservedRobot& model, const Observations& observations)
      : model_(model), observations_(observations), touches_(TouchesAmong(model, observations)) {}

  std::vector<TouchInTheAir> Run() {
    if (static_cast<int>(touches_.size()) < kFewestTouchesTold) return {};
    const ObservationFit start = StartFit(model_, observations_);
    const ObservationFit all = FitObservations(model_, observations_, start, {});
    noise_ = all.spread[kHeight];
    if (noise_ < kNoiseThatMatters) return {};
    const ObservationFit placed = FitObservations(model_, observations_, start,
                                                  {.freedom = {.robot = false}, .robust = true});
    for (const ObservationFit* from : {&all, &placed}) {
      for (const double share : kStartShares) Try(Closest(HeightsOf(*from), share));
    }
    return best_;
  }

 private:
  /// For each touch: its height above the table.
  std::vector<double> HeightsOf(const ObservationFit& fit) const {
    const std::vector<Eigen::VectorXd> left = LeftOf(model_, observations_, fit.values);
    std::vector<double> heights;
    for (const int touch : touches_) heights.push_back(left[Size(touch)][0]);
    return heights;
  }

  /// For each plate: marks the given share of its touches whose heights are closest together.
  std::vector<char> Closest(const std::vector<double>& heights, double share) const {
    std::vector<char> closest(touches_.size(), 0);
    for (int plate = 0; plate < static_cast<int>(model_.setup.plates.size()); ++plate) {
      std::vector<std::size_t> own;
      for (std::size_t t = 0; t < touches_.size(); ++t) {
        if (observations_.all[Size(touches_[t])].instrument == plate) own.push_back(t);
      }
      if (own.empty()) continue;
      std::sort(own.begin(), own.end(),
                [&](std::size_t a, std::size_t b) { return heights[a] < heights[b]; });
      const std::size_t count = std::max<std::size_t>(
          1, static_cast<std::size_t>(share * static_cast<double>(own.size())));
      std::size_t first = 0;
      const auto width = [&](std::size_t i) {
        return heights[own[i + count - 1]] - heights[own[i]];
      };
      for (std::size_t i = 1; i + count <= own.size(); ++i) {
        if (width(i) < width(first)) first = i;
      }
      for (std::size_t i = first; i < first + count; ++i) closest[own[i]] = 1;
    }
    return closest;
  }

  ObservationFit FitTo(const std::vector<char>& on) const {
    ObservationFit start = StartFit(model_, observations_);
    for (std::size_t t = 0; t < touches_.size(); ++t) {
      if (on[t] == 0) start.weights[Size(touches_[t])] = 0.0;
    }
    return FitObservations(model_, observations_, start, {});
  }

  /// For each touch: standard deviation of its height minus the prediction by a fit to the touches
  /// marked in `on`; for these themselves that of the noise.
  std::vector<double> Doubts(const ObservationFit& fit, const std::vector<char>& on) const {
    ObservationResiduals told(model_, observations_, fit.loads, fit.spread, fit.weights, {},
                              fit.values);
    told.Evaluate(told.Start(), true);
    const Eigen::MatrixXd covariance = InverseOfInformation(NormalEquations(told).information());
    const std::vector<double> whole(fit.weights.size(), 1.0);
    ObservationResiduals all(model_, observations_, fit.loads, fit.spread, whole, {}, fit.values);
    all.Evaluate(all.Start(), true);
    const auto explained = NormalEquations(all).ExplainedVariances(covariance).all;
    std::vector<double> doubts;
    for (std::size_t t = 0; t < touches_.size(); ++t) {
      const double more = on[t] != 0 ? 0.0 : explained[Size(touches_[t])][0];
      doubts.push_back(fit.spread[kHeight] * std::sqrt(1.0 + more));
    }
    return doubts;
  }

  /// Repeats the fit, starting from touches that seem to lie on their tables, and adds all touches
  /// that it explains.
  void Try(std::vector<char> on) {
    std::set<std::vector<char>> seen;
    for (int round = 0; round < kMostRounds && seen.insert(on).second; ++round) {
      InterruptionPoint();
      const ObservationFit fit = FitTo(on);
      const std::vector<double> heights = HeightsOf(fit), doubts = Doubts(fit, on);
      std::vector<char> next(on.size());
      for (std::size_t t = 0; t < on.size(); ++t) next[t] = heights[t] < kExplained * doubts[t];
      if (next == on) {
        Judge(on, heights, fit.spread[kHeight]);
        return;
      }
      on = std::move(next);
    }
  }

  /// Takes the touches that stay out, if they are in the air and less noise is left than with those
  /// found before.
  void Judge(const std::vector<char>& on, const std::vector<double>& heights, double noise) {
    std::vector<TouchInTheAir> air;
    std::vector<double> high;
    for (std::size_t t = 0; t < on.size(); ++t) {
      if (on[t] != 0) continue;
      air.push_back({touches_[t], heights[t]});
      high.push_back(heights[t]);
    }
    const auto lying = static_cast<double>(on.size() - air.size());
    if (air.empty() || lying < kFewestShare * static_cast<double>(on.size())) return;
    std::sort(high.begin(), high.end());
    if (high[high.size() / 2] < kHighAbove * noise || noise > kNoiseLeft * noise_) return;
    if (!best_.empty() && noise >= least_) return;
    best_ = std::move(air);
    least_ = noise;
  }

  const ObservedRobot& model_;
  const Observations& observations_;
  std::vector<int> touches_;
  double noise_ = 0.0;  // of heights, with all touches
  double least_ = 0.0;  // of heights, without the touches in `best_`
  std::vector<TouchInTheAir> best_;
};

}  // namespace

std::vector<TouchInTheAir> FindTouchesInTheAir(const ObservedRobot& model,
                                               const Observations& observations) {
  return AirSearch(model, observations).Run();
}

Observations WithoutTouches(const Observations& observations,
                            const std::vector<TouchInTheAir>& touches) {
  std::set<int> out;
  for (const TouchInTheAir& touch : touches) out.insert(touch.observation);
  return WithoutObservations(observations, out);
}

}  // namespace elastocal
