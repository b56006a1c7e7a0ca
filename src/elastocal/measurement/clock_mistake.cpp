// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/clock_mistake.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace elastocal {
namespace {

constexpr double kLeastClockPeak = 0.9;  // what is right correlates well
constexpr double kClearlyBetter = 0.25;  // of what a correlation lacks to one is left
constexpr double kStep_s = 0.6;          // of two rates tried, at the end of the log
constexpr double kFarthestRate = 0.2;
constexpr int kMostRates = 200;
constexpr int kCuts = 16;
constexpr double kLeastJump_s = 0.1;

/// The rows of the log in [begin, end).
LoggedSpeeds Part(const LoggedSpeeds& logged, Eigen::Index begin, Eigen::Index end) {
  return {logged.time_s.segment(begin, end - begin), logged.speeds.middleRows(begin, end - begin)};
}

}  // namespace

std::optional<ClockMistake> FindClockMistake(const Eigen::MatrixXd& measured, double rate_hz,
                                             const LoggedSpeeds& logged,
                                             const std::optional<double>& expected_lag_s,
                                             const ClockOptions& options, double peak) {
  const Eigen::Index rows = logged.time_s.size();
  if (rows < 2 * kCuts) return std::nullopt;
  const double start = logged.time_s[0];
  const double span = logged.time_s[rows - 1] - start;
  const double least_peak = std::max(kLeastClockPeak, 1.0 - kClearlyBetter * (1.0 - peak));
  std::optional<ClockMistake> best;
  const auto try_rate = [&](double rate) {
    LoggedSpeeds stretched = logged;
    stretched.time_s = start + rate * (logged.time_s.array() - start);
    const ClockFit fit = EstimateTrialClock(measured, rate_hz, stretched, expected_lag_s, options);
    if (fit.peak >= least_peak && (!best || fit.peak > best->peak))
      best = ClockMistake{.rate = rate, .peak = fit.peak};
  };
  const double step = std::max(kStep_s / span, 2.0 * kFarthestRate / kMostRates);
  for (int k = 1; k * step <= kFarthestRate; ++k) {
    for (const double sign : {-1.0, 1.0}) try_rate(1.0 + sign * k * step);
  }
  if (best) {  // once more between its neighbours
    const double coarse = best->rate;
    for (const double share : {-0.67, -0.33, 0.33, 0.67}) try_rate(coarse + share * step);
    return best;
  }
  for (const double rate : {0.5, 2.0}) try_rate(rate);
  if (best) return best;

  for (int cut = 3; cut <= kCuts - 3; ++cut) {
    const Eigen::Index row = rows * cut / kCuts;
    const auto lag_of = [&](Eigen::Index begin, Eigen::Index end) {
      return EstimateTrialClock(measured, rate_hz, Part(logged, begin, end), expected_lag_s,
                                options);
    };
    const Eigen::Index around = rows / (2 * kCuts) + 1;  // a cut of the log is in some gap
    const ClockFit before = lag_of(0, row - around);
    if (before.peak < least_peak) continue;
    const ClockFit after = lag_of(row + around, rows);
    const double least = std::min(before.peak, after.peak);
    const double jump = before.lag_s - after.lag_s;
    if (least < least_peak || std::abs(jump) < kLeastJump_s) continue;
    if (!best || least > best->peak)
      best = {.jump_s = jump, .at_s = logged.time_s[row], .peak = least};
  }
  return best;
}

std::string Describe(const ClockMistake& mistake) {
  char text[200];
  if (mistake.jump_s != 0.0) {
    std::snprintf(text, sizeof text,
                  "if the log's clock jumped by %.2f s at about %.0f s of its time, the log fits "
                  "(correlation %.2f)",
                  mistake.jump_s, mistake.at_s, mistake.peak);
  } else {
    std::snprintf(text, sizeof text,
                  "if the log's clock ran %.1f %% %s, the log fits (correlation %.2f): rows may be "
                  "missing, or its rate is another",
                  100.0 * std::abs(1.0 - 1.0 / mistake.rate), mistake.rate > 1.0 ? "slow" : "fast",
                  mistake.peak);
  }
  return text;
}

}  // namespace elastocal
