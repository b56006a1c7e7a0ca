// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/metrics.hpp"

#include <cmath>
#include <limits>

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
  return metrics;
}

}  // namespace elastocal
