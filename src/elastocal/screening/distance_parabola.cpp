// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/distance_parabola.hpp"

#include <cmath>
#include <utility>

#include "elastocal/calibration/prediction.hpp"

namespace elastocal {

Eigen::VectorXd SquaresByPosture(const CalibrationResult& result, const Recording& recording,
                                 const CalibrationOptions& options) {
  const Eigen::MatrixXd distances =
      Predict(result.model, result.delta, recording, options, &result.placement).distances;
  return distances.unaryExpr([](double d) { return std::isfinite(d) ? d * d : 0.0; })
      .rowwise()
      .sum();
}

Eigen::ArrayXd DistanceParabola::ToLeast(double least) const {
  const Eigen::ArrayXd curvature = Curvature();
  return (curvature > least).select(0.5 * (before - after).array() / curvature, 0.0);
}

DistanceParabola ParabolaOf(const CalibrationResult& result, const Recording& recording,
                            int coordinate, double step, const Eigen::VectorXd& squares,
                            const CalibrationOptions& options) {
  Recording other = recording;
  other.q.col(coordinate).array() -= step;
  Eigen::VectorXd before = SquaresByPosture(result, other, options);
  other.q.col(coordinate).array() += 2.0 * step;
  return {std::move(before), squares, SquaresByPosture(result, other, options)};
}

}  // namespace elastocal
