// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/encoder_starts.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>

namespace elastocal {
namespace {

constexpr int kFewestReadings = 8;
constexpr double kLargestStep = 2e-3;    // rad or m: commanded positions differ by more
constexpr double kSmallestStep = 1e-8;   // rad or m: smaller changes are rounding errors
constexpr int kMostSteps = 3;            // a change is tried as one to so many steps
constexpr double kSameRemainder = 4e-3;  // remainders that differ by less of a step are equal
constexpr double kChance = 1e-6;         // that a column seems to tell starts though it does not
constexpr double kMostChanges = 0.25;    // largest share of rows that begin another start
constexpr int kFewestFractions = 8;      // fewer parts of a step may be steps of a finer encoder
constexpr int kMostFractions = 64;       // finest rounding of readings, parts of a step

/// Distance of a number from the nearest whole one.
double OffWhole(double value) { return std::abs(value - std::round(value)); }

/// For each reading, the number of its remainder after division by the step. Remainders are
/// numbered in order of appearance.
std::vector<int> ByRemainder(const Eigen::VectorXd& readings, double step) {
  std::vector<double> known;
  std::vector<int> numbers;
  for (double reading : readings) {
    const auto same = [&](double other) {
      return OffWhole((reading - other) / step) < kSameRemainder;
    };
    const auto found = std::find_if(known.begin(), known.end(), same);
    numbers.push_back(static_cast<int>(found - known.begin()));
    if (found == known.end()) known.push_back(reading);
  }
  return numbers;
}

/// The least number of equal parts of a step of which all changes are multiples; `kMostFractions`
/// if there is none below.
int FractionsOfStep(const Eigen::VectorXd& changes, double step) {
  for (int fractions = 1; fractions < kMostFractions; ++fractions) {
    const bool rounded = std::all_of(changes.begin(), changes.end(), [&](double change) {
      return OffWhole(fractions * change / step) < kSameRemainder * fractions;
    });
    if (rounded) return fractions;
  }
  return kMostFractions;
}

/// Probability of at least `hits` hits in `trials` trials.
double BinomialTail(int hits, int trials, double chance) {
  double tail = 0.0;
  for (int k = hits; k <= trials; ++k) {
    const double ways =
        std::lgamma(trials + 1.0) - std::lgamma(k + 1.0) - std::lgamma(trials - k + 1.0);
    tail += std::exp(ways + k * std::log(chance) + (trials - k) * std::log1p(-chance));
  }
  return tail;
}

/// Changes of a column from row to row, where it changes.
Eigen::VectorXd ChangesOf(const Eigen::VectorXd& readings) {
  std::vector<double> changes;
  for (Eigen::Index i = 1; i < readings.size(); ++i) {
    const double change = readings[i] - readings[i - 1];
    if (std::abs(change) > kSmallestStep) changes.push_back(change);
  }
  return Eigen::Map<const Eigen::VectorXd>(changes.data(),
                                           static_cast<Eigen::Index>(changes.size()));
}

/// The largest step that divides at least half of the changes, and does so by chance with a
/// probability below `kChance`. Readings that are rounded to few parts of a step are refused,
/// because many changes would then be multiples by chance.
std::optional<double> FindStep(const Eigen::VectorXd& changes) {
  std::vector<double> candidates;
  for (double change : changes) {
    for (int steps = 1; steps <= kMostSteps; ++steps) {
      const double step = std::abs(change) / steps;
      if (step >= kSmallestStep && step <= kLargestStep) candidates.push_back(step);
    }
  }
  std::sort(candidates.begin(), candidates.end(), std::greater<>());
  for (double step : candidates) {
    const auto whole =
        static_cast<int>(std::count_if(changes.begin(), changes.end(), [&](double change) {
          return OffWhole(change / step) < kSameRemainder;
        }));
    const int all = static_cast<int>(changes.size());
    const int fractions = FractionsOfStep(changes, step);
    if (2 * whole < all || fractions < kFewestFractions) continue;
    // The change that proposed the step is whole in any case.
    if (BinomialTail(whole - 1, all - 1, 1.0 / fractions) < kChance) return step;
  }
  return std::nullopt;
}

bool ChangesRarely(const std::vector<int>& numbers) {
  int changes = 0;
  for (std::size_t i = 1; i < numbers.size(); ++i) changes += numbers[i] != numbers[i - 1] ? 1 : 0;
  return changes > 0 && changes <= kMostChanges * static_cast<double>(numbers.size() - 1);
}

}  // namespace

int EncoderStarts::count() const {
  return start.empty() ? 0 : 1 + *std::max_element(start.begin(), start.end());
}

EncoderStarts FindEncoderStarts(const Eigen::MatrixXd& readings) {
  EncoderStarts starts;
  std::vector<std::vector<int>> keys(static_cast<std::size_t>(readings.rows()));
  for (Eigen::Index c = 0; c < readings.cols(); ++c) {
    if (readings.rows() < kFewestReadings || !readings.col(c).allFinite()) continue;
    const std::optional<double> step = FindStep(ChangesOf(readings.col(c)));
    if (!step) continue;
    const std::vector<int> numbers = ByRemainder(readings.col(c), *step);
    if (!ChangesRarely(numbers)) continue;
    starts.columns.push_back(static_cast<int>(c));
    starts.steps.push_back(*step);
    for (std::size_t row = 0; row < keys.size(); ++row) keys[row].push_back(numbers[row]);
  }
  if (starts.columns.empty()) return starts;
  std::map<std::vector<int>, int> known;
  for (const std::vector<int>& key : keys) {
    starts.start.push_back(known.emplace(key, static_cast<int>(known.size())).first->second);
  }
  return starts;
}

}  // namespace elastocal
