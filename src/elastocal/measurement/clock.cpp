// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/clock.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <stdexcept>

#include "elastocal/measurement/clock_correlation.hpp"
#include "elastocal/measurement/clock_windows.hpp"
#include "elastocal/measurement/frame_interval.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kLeastWindows = 3;  // two give a line without a residual
constexpr double kMostWindows = 200.0;    // keeps the cost of all pairs of windows bounded
constexpr double kLeastUsed = 2.0 / 3.0;  // least share of the windows that must be on the line

void CheckArguments(const MeasuredSpeed& measured, const PredictedSpeed& predicted,
                    const ClockOptions& options) {
  const auto require = [](bool holds, const char* expected) {
    if (!holds) throw std::invalid_argument(std::string("clocks: expected ") + expected);
  };
  require(measured.rate_hz > 0.0 && measured.values.size() > 0, "measured speeds with a rate");
  require(predicted.time_s.size() >= 2, "at least two predicted speeds");
  require(predicted.time_s.size() == predicted.values.size(), "as many times as predicted speeds");
  for (Eigen::Index i = 1; i < predicted.time_s.size(); ++i) {
    require(predicted.time_s[i] > predicted.time_s[i - 1], "times that increase");
  }
  require(options.longest_lag_s > 0.0 && options.window_s > 0.0,
          "a longest lag and window above 0");
}

// The windows with motion and their lags, or one window of the whole trial if these are too few.
std::vector<WindowLag> FitWindows(const UniformSpeed& measured, const UniformSpeed& predicted,
                                  double window_s, double coarse_lag_s) {
  const int frames = static_cast<int>(measured.values.size());
  const double duration = frames / measured.rate_hz;
  const int length =
      std::max(1, static_cast<int>(
                      std::lround(std::max(window_s, duration / kMostWindows) * measured.rate_hz)));
  std::vector<WindowLag> windows;
  for (int begin = 0; begin + length <= frames; begin += length) {
    const auto lag = FitWindowLag(measured, predicted, {begin, begin + length}, coarse_lag_s);
    if (lag) windows.push_back(*lag);
  }
  if (windows.size() >= kLeastWindows) return windows;

  // Takes only the frames that the log covers, because most of a window must be known.
  const auto frame_at = [&](double robot_time) {
    const double frame = (robot_time + coarse_lag_s) * measured.rate_hz;
    return static_cast<int>(std::clamp<double>(frame, 0.0, frames));
  };
  const double end_s =
      predicted.start_s + static_cast<double>(predicted.values.size()) / predicted.rate_hz;
  const auto lag = FitWindowLag(measured, predicted, {frame_at(predicted.start_s), frame_at(end_s)},
                                coarse_lag_s);
  windows.clear();
  if (lag) windows.push_back(*lag);
  return windows;
}

// Number of frames in which both are known, and the first and last camera time of these.
struct Overlap {
  int count = 0;
  double begin_s = 0.0;
  double end_s = 0.0;

  Overlap(const UniformSpeed& measured, const UniformSpeed& predicted, double lag_s) {
    for (Eigen::Index frame = 0; frame < measured.values.size(); ++frame) {
      const double time = static_cast<double>(frame) / measured.rate_hz;
      const auto index = std::llround((time - lag_s - predicted.start_s) * predicted.rate_hz);
      if (std::isnan(measured.values[frame]) || index < 0 || index >= predicted.values.size() ||
          std::isnan(predicted.values[index])) {
        continue;
      }
      if (count == 0) begin_s = time;
      end_s = time;
      ++count;
    }
  }
};

void FitDrift(const Overlap& overlap, ClockFit& fit) {
  if (fit.windows.size() < kLeastWindows) {
    if (fit.windows.empty()) return;
    fit.lag_s = fit.windows[0].lag_s;
    fit.sd_s = fit.windows[0].sd_s;
    return;
  }
  const LagLine line = FitLine(fit.windows);
  fit.drift_estimated = true;
  fit.lag_s = line.Lag(0.0);
  fit.drift_ppm = -1e6 * line.slope;
  fit.line_residual_s = line.residual_s;
  fit.sd_s = std::max(line.Sd(overlap.begin_s), line.Sd(overlap.end_s));
}

ClockState Judge(const ClockFit& fit, const CorrelationPeaks& peaks, const ClockOptions& options) {
  if (peaks.peak < options.least_peak) return ClockState::kWeak;
  if (peaks.at_the_rim) return ClockState::kAtTheRim;
  const double unexplained = 1.0 - peaks.peak * peaks.peak;
  const double unexplained_by_second = 1.0 - peaks.second_peak * peaks.second_peak;
  if (peaks.second_peak > options.largest_second_peak * peaks.peak &&
      unexplained_by_second < options.clear_residual_ratio * unexplained) {
    return ClockState::kAmbiguous;
  }
  if (fit.windows.empty()) return ClockState::kImprecise;
  const auto used = std::count_if(fit.windows.begin(), fit.windows.end(),
                                  [](const WindowLag& window) { return window.used; });
  if (fit.line_residual_s > options.largest_line_residual_s ||
      static_cast<double>(used) < kLeastUsed * static_cast<double>(fit.windows.size())) {
    return ClockState::kUnsteady;
  }
  return fit.sd_s <= options.largest_sd_s ? ClockState::kReliable : ClockState::kImprecise;
}

}  // namespace

ClockFit EstimateClock(const MeasuredSpeed& measured, const PredictedSpeed& predicted,
                       const ClockOptions& options) {
  CheckArguments(measured, predicted, options);
  const UniformSpeed seen{0.0, measured.rate_hz, measured.values};
  const UniformSpeed expected = Resample(predicted, measured.rate_hz);
  const CorrelationPeaks peaks = Correlate(seen, expected, options);
  ClockFit fit;
  if (!peaks.overlap) return fit;
  fit.lag_s = peaks.lag_s;
  fit.peak = peaks.peak;
  fit.second_peak = peaks.second_peak;
  fit.second_lag_s = peaks.second_lag_s;
  const Overlap overlap(seen, expected, peaks.lag_s);
  fit.overlap_s = overlap.count / measured.rate_hz;
  fit.windows = FitWindows(seen, expected, options.window_s, peaks.lag_s);
  FitDrift(overlap, fit);
  fit.state = Judge(fit, peaks, options);
  return fit;
}

std::string Describe(const ClockFit& fit) {
  const auto format = [](const char* pattern, auto... values) {
    char text[256];
    std::snprintf(text, sizeof(text), pattern, values...);
    return std::string(text);
  };
  switch (fit.state) {
    case ClockState::kReliable:
      return format("clock lag %.4f s (sd %.2f ms), drift %.1f ppm", fit.lag_s, 1e3 * fit.sd_s,
                    fit.drift_ppm);
    case ClockState::kNoOverlap:
      return "the marker file and the joint log have too little in common at any lag";
    case ClockState::kWeak:
      return format(
          "marker speeds and joint log do not agree at any lag (correlation %.2f at most; is "
          "the log that of this trial?)",
          fit.peak);
    case ClockState::kAmbiguous:
      return format(
          "the clock lag is ambiguous: correlation %.4f at %.2f s, but %.4f at another lag (is the "
          "log that of this trial, or does the motion repeat itself?)",
          fit.peak, fit.lag_s, fit.second_peak);
    case ClockState::kAtTheRim:
      return format("the clock lag lies at or beyond the end of the searched range, %.2f s",
                    fit.lag_s);
    case ClockState::kUnsteady:
      return format("the clock lag does not change steadily: %.1f ms off a line over the trial",
                    1e3 * fit.line_residual_s);
    case ClockState::kImprecise:
      if (fit.windows.empty()) {
        return format("no part of the trial tells the clock lag, which seems to be near %.2f s",
                      fit.lag_s);
      }
      return format("too little motion to tell the clock lag: %.3f s with sd %.1f ms", fit.lag_s,
                    1e3 * fit.sd_s);
  }
  return "";
}

}  // namespace elastocal
