// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/clock_mistake.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "elastocal/measurement/clock_correlation.hpp"

namespace elastocal {
namespace {

constexpr double kLeastClockPeak = 0.9;  // least correlation of a clock that is right
constexpr double kClearlyBetter = 0.25;  // largest share that is left of 1 - correlation
constexpr double kStep_s = 0.6;          // by which two rates differ at the end of the log
constexpr double kFarthestRate = 0.2;
constexpr int kMostRates = 200;
constexpr int kCuts = 16;      // parts of the log, between which its clock may jump
constexpr int kLeastPart = 3;  // parts that must be on either side of the jump
constexpr double kLeastJump_s = 0.1;
constexpr double kMostUnseen = 0.1;  // largest share of a part's time without cameras

/// Correlation of the cameras' speeds with those of the log's rows `begin` to `end` - 1, whose
/// clock is corrected by `rate`.
CorrelationPeaks Correlation(const MeanSpeeds& speeds, double rate, Eigen::Index begin,
                             Eigen::Index end) {
  const double start = speeds.logged.time_s[0];
  const PredictedSpeed part{
      start + rate * (speeds.logged.time_s.segment(begin, end - begin).array() - start),
      speeds.logged.values.segment(begin, end - begin)};
  const double rate_hz = speeds.measured.rate_hz;
  return Correlate({0.0, rate_hz, speeds.measured.values}, Resample(part, rate_hz), speeds.options);
}

std::optional<ClockMistake> FindRate(const MeanSpeeds& speeds, double least_peak) {
  const Eigen::Index rows = speeds.logged.time_s.size();
  std::optional<ClockMistake> best;
  const auto try_rate = [&](double rate) {
    const CorrelationPeaks found = Correlation(speeds, rate, 0, rows);
    if (!found.overlap || found.peak < least_peak || (best && found.peak <= best->peak)) return;
    best = ClockMistake{.rate = rate, .peak = found.peak};
  };
  const double span = speeds.logged.time_s[rows - 1] - speeds.logged.time_s[0];
  const double step = std::max(kStep_s / span, 2.0 * kFarthestRate / kMostRates);
  for (int k = 1; k * step <= kFarthestRate; ++k) {
    for (const double sign : {-1.0, 1.0}) try_rate(1.0 + sign * k * step);
  }
  if (best) {  // search once more, more finely, between its neighbours
    const double coarse = best->rate;
    for (int k = -4; k <= 4; ++k) try_rate(coarse + 0.2 * k * step);
    return best;
  }
  for (const double rate : {0.5, 2.0}) try_rate(rate);
  return best;
}

/// Where the cameras see a part of the log, s of their clock.
struct CameraSpan {
  double begin_s = 0.0, end_s = 0.0;
};

std::optional<ClockMistake> FindJump(const MeanSpeeds& speeds, double least_peak) {
  const Eigen::VectorXd& time = speeds.logged.time_s;
  const Eigen::Index rows = time.size();
  const Eigen::Index around = rows / (2 * kCuts) + 1;  // the jump is within so many rows of a cut
  const double camera_s =
      static_cast<double>(speeds.measured.values.size()) / speeds.measured.rate_hz;
  std::optional<ClockMistake> best;
  for (int cut = kLeastPart; cut <= kCuts - kLeastPart; ++cut) {
    const Eigen::Index row = rows * cut / kCuts;
    const CorrelationPeaks before = Correlation(speeds, 1.0, 0, row - around);
    const CorrelationPeaks after = Correlation(speeds, 1.0, row + around, rows);
    if (!before.overlap || !after.overlap) continue;
    // A part that the cameras hardly saw fits by chance. The second part must follow the first.
    const CameraSpan first{time[0] + before.lag_s, time[row - around - 1] + before.lag_s};
    const CameraSpan second{time[row + around] + after.lag_s, time[rows - 1] + after.lag_s};
    const bool possible = first.begin_s > -kMostUnseen * (first.end_s - first.begin_s) &&
                          second.end_s < camera_s + kMostUnseen * (second.end_s - second.begin_s) &&
                          first.end_s < second.begin_s;
    const double least = std::min(before.peak, after.peak);
    const double jump = before.lag_s - after.lag_s;
    if (!possible || least < least_peak || std::abs(jump) < kLeastJump_s) continue;
    if (best && least <= best->peak) continue;
    best = {.jump_s = jump, .at_s = time[row], .peak = least};
  }
  return best;
}

}  // namespace

std::optional<ClockMistake> FindClockMistake(const MeanSpeeds& speeds, double peak) {
  if (speeds.logged.time_s.size() < 2 * kCuts) return std::nullopt;
  const double least_peak = std::max(kLeastClockPeak, 1.0 - kClearlyBetter * (1.0 - peak));
  const auto rate = FindRate(speeds, least_peak), jump = FindJump(speeds, least_peak);
  if (rate && jump) return rate->peak > jump->peak ? rate : jump;
  return rate ? rate : jump;
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
