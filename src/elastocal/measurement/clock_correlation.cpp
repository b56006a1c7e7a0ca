// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/clock_correlation.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

constexpr double kLongestHole_s = 0.1;
constexpr double kCoarseRate_hz = 20.0;  // four times the cutoff of the marker filter
constexpr double kLeastShare = 0.5;      // share of the shorter signal that must be in common
constexpr int kLeastCount = 50;          // coarse samples in common
constexpr double kDip = 0.03;  // depth of a dip between two peaks, as a share of the highest

// Means of blocks of values. NaN if less than half of a block is known.
UniformSpeed Decimate(const UniformSpeed& fine, int factor) {
  UniformSpeed coarse;
  coarse.start_s = fine.start_s + 0.5 * (factor - 1) / fine.rate_hz;
  coarse.rate_hz = fine.rate_hz / factor;
  coarse.values.resize(fine.values.size() / factor);
  for (Eigen::Index k = 0; k < coarse.values.size(); ++k) {
    double sum = 0.0;
    int known = 0;
    for (const double value : fine.values.segment(k * factor, factor)) {
      if (std::isnan(value)) continue;
      sum += value;
      ++known;
    }
    coarse.values[k] = 2 * known >= factor ? sum / known : kNaN;
  }
  return coarse;
}

// A signal with unknown samples, ready for correlation: unknown samples are zero.
struct Masked {
  Eigen::VectorXd known;  // 1 or 0
  Eigen::VectorXd value;  // with the mean taken off
  Eigen::VectorXd square;

  explicit Masked(const Eigen::VectorXd& raw)
      : known(raw.array().isNaN().select(0.0, Eigen::ArrayXd::Ones(raw.size()))),
        value(raw.array().isNaN().select(0.0, raw)) {
    value = known.cwiseProduct((value.array() - value.sum() / known.sum()).matrix());
    square = value.cwiseAbs2();
  }
};

// Correlation of x[k] with y[k + shift] over all k for which both are known; NaN if these are too
// few.
double CorrelationAt(const Masked& x, const Masked& y, Eigen::Index shift, double least_count) {
  const Eigen::Index begin = std::max<Eigen::Index>(0, -shift);
  const Eigen::Index size = std::min(x.value.size(), y.value.size() - shift) - begin;
  if (size <= 0) return kNaN;
  const auto of_x = [&](const Eigen::VectorXd& v) { return v.segment(begin, size); };
  const auto of_y = [&](const Eigen::VectorXd& v) { return v.segment(begin + shift, size); };
  const double count = of_x(x.known).dot(of_y(y.known));
  if (count < least_count) return kNaN;
  const double mean_x = of_x(x.value).dot(of_y(y.known)) / count;
  const double mean_y = of_x(x.known).dot(of_y(y.value)) / count;
  const double xx = of_x(x.square).dot(of_y(y.known)) / count - mean_x * mean_x;
  const double yy = of_x(x.known).dot(of_y(y.square)) / count - mean_y * mean_y;
  const double xy = of_x(x.value).dot(of_y(y.value)) / count - mean_x * mean_y;
  return xx > 0.0 && yy > 0.0 ? xy / std::sqrt(xx * yy) : 0.0;
}

// Where the highest value is that a dip separates from the highest one of all; nothing without one.
std::optional<Eigen::Index> SecondPeak(const Eigen::VectorXd& correlations, Eigen::Index best) {
  const double dip = kDip * correlations[best];
  std::optional<Eigen::Index> second;
  for (const int step : {-1, 1}) {
    double lowest = correlations[best];
    for (Eigen::Index i = best + step; i >= 0 && i < correlations.size(); i += step) {
      if (std::isnan(correlations[i])) break;
      lowest = std::min(lowest, correlations[i]);
      if (!(correlations[i] > std::max(0.0, lowest + dip))) continue;
      if (!second || correlations[i] > correlations[*second]) second = i;
    }
  }
  return second;
}

// Offset, in steps, of the top of the parabola through three neighbours.
double ParabolaTop(double left, double middle, double right) {
  const double curvature = left - 2.0 * middle + right;
  return curvature < 0.0 ? 0.5 * (left - right) / curvature : 0.0;
}

}  // namespace

UniformSpeed Resample(const PredictedSpeed& predicted, double rate_hz) {
  const Eigen::VectorXd& time = predicted.time_s;
  UniformSpeed result{time[0], rate_hz, {}};
  const double duration = time[time.size() - 1] - time[0];
  // The slack keeps rounding from losing the last sample.
  result.values.resize(1 + static_cast<Eigen::Index>(duration * rate_hz + 1e-6));
  Eigen::Index next = 1;  // the first log sample after the time of interest
  for (Eigen::Index k = 0; k < result.values.size(); ++k) {
    const double t = time[0] + static_cast<double>(k) / rate_hz;
    while (next + 1 < time.size() && time[next] < t) ++next;
    const double step = time[next] - time[next - 1];
    const double u = (t - time[next - 1]) / step;
    const bool hole = step > kLongestHole_s && u > 0.0 && u < 1.0;
    result.values[k] =
        hole ? kNaN : (1.0 - u) * predicted.values[next - 1] + u * predicted.values[next];
  }
  return result;
}

CorrelationPeaks Correlate(const UniformSpeed& measured, const UniformSpeed& predicted,
                           const ClockOptions& options) {
  CorrelationPeaks result;
  const int factor = std::max(1, static_cast<int>(std::lround(measured.rate_hz / kCoarseRate_hz)));
  const UniformSpeed coarse_measured = Decimate(measured, factor);
  const UniformSpeed coarse_predicted = Decimate(predicted, factor);
  const Masked x(coarse_measured.values);
  const Masked y(coarse_predicted.values);
  const double least_count =
      std::max<double>(kLeastCount, kLeastShare * std::min(x.known.sum(), y.known.sum()));

  // Measured sample k, at its time t, is compared with predicted sample k + shift, at t - lag.
  const double offset = coarse_measured.start_s - coarse_predicted.start_s;
  const double rate = coarse_measured.rate_hz;
  const auto shift_of = [&](double lag) { return (offset - lag) * rate; };
  const auto first = static_cast<Eigen::Index>(
      std::floor(shift_of(options.expected_lag_s + options.longest_lag_s)));
  const auto last = static_cast<Eigen::Index>(
      std::ceil(shift_of(options.expected_lag_s - options.longest_lag_s)));
  Eigen::VectorXd correlations(last - first + 1);
  Eigen::Index best = -1;
  for (Eigen::Index i = 0; i < correlations.size(); ++i) {
    correlations[i] = CorrelationAt(x, y, first + i, least_count);
    if (std::isnan(correlations[i])) continue;
    if (best < 0 || correlations[i] > correlations[best]) best = i;
  }
  if (best < 0) return result;

  result.overlap = true;
  result.peak = correlations[best];
  if (const auto second = SecondPeak(correlations, best)) {
    result.second_peak = correlations[*second];
    result.second_lag_s = offset - static_cast<double>(first + *second) / rate;
  }
  result.at_the_rim = best == 0 || best == correlations.size() - 1 ||
                      std::isnan(correlations[best - 1]) || std::isnan(correlations[best + 1]);
  auto shift = static_cast<double>(first + best);
  if (!result.at_the_rim) {
    shift += ParabolaTop(correlations[best - 1], correlations[best], correlations[best + 1]);
  }
  result.lag_s = offset - shift / rate;
  return result;
}

}  // namespace elastocal
