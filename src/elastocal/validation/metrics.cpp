// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/metrics.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "elastocal/math/statistics.hpp"

namespace elastocal {

ErrorMetrics ComputeMetrics(const Eigen::MatrixXd& distances, const ObservationMask& mask) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  ErrorMetrics metrics;
  metrics.marker_rmse_3d.setConstant(mask.cols(), kNone);
  double total = 0.0;
  for (Eigen::Index m = 0; m < mask.cols(); ++m) {
    double marker_total = 0.0;
    int marker_count = 0;
    for (Eigen::Index i = 0; i < mask.rows(); ++i) {
      if (!mask(i, m) || !std::isfinite(distances(i, m))) continue;
      marker_total += distances(i, m) * distances(i, m);
      metrics.maximum = std::max(metrics.maximum, distances(i, m));
      ++marker_count;
    }
    if (marker_count > 0) metrics.marker_rmse_3d[m] = std::sqrt(marker_total / marker_count);
    total += marker_total;
    metrics.observations += marker_count;
  }
  metrics.rmse_3d = metrics.observations > 0 ? std::sqrt(total / metrics.observations) : kNone;
  metrics.rmse_coordinate = metrics.rmse_3d / std::sqrt(3.0);
  if (metrics.observations == 0) metrics.maximum = kNone;
  return metrics;
}

std::optional<RmseInterval> IntervalOfRmse(const Eigen::MatrixXd& distances,
                                           const std::vector<int>& unit_of) {
  constexpr std::size_t kFewestUnits = 5;
  std::map<int, std::pair<double, double>> units;  // sum of squares, observations
  double squares = 0.0, observations = 0.0;
  for (Eigen::Index i = 0; i < distances.rows(); ++i) {
    for (double distance : distances.row(i)) {
      if (!std::isfinite(distance)) continue;
      auto& [unit_squares, count] = units[unit_of[static_cast<std::size_t>(i)]];
      unit_squares += distance * distance;
      count += 1.0;
      squares += distance * distance;
      observations += 1.0;
    }
  }
  if (units.size() < kFewestUnits || !(squares > 0.0)) return std::nullopt;
  const double mean = squares / observations;
  double scatter = 0.0;
  for (const auto& [unit, sums] : units) {
    scatter += std::pow(sums.first - mean * sums.second, 2);
  }
  const auto count = static_cast<double>(units.size());
  const double sd = std::sqrt(scatter * count / (count - 1.0)) / squares;  // of the mean, relative
  const double half = 0.5 * StudentQuantile(0.975, count - 1.0) * sd;
  return RmseInterval{std::sqrt(mean) * std::exp(-half), std::sqrt(mean) * std::exp(half)};
}

}  // namespace elastocal
