// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/bspline.hpp"

#include <algorithm>
#include <stdexcept>

namespace elastocal {
namespace {

constexpr int kDegree = 5;

/// Knot of the clamped uniform knot vector of `spans` spans.
double Knot(int i, int spans) {
  return std::clamp(i - kDegree, 0, spans) / static_cast<double>(spans);
}

/// B-splines of a lower degree on the same knots (Cox - de Boor), spans + kDegree + (kDegree -
/// degree) of them.
Eigen::VectorXd Basis(int degree, int spans, double place) {
  const int intervals = spans + 2 * kDegree;
  const int span = std::min(static_cast<int>(place * spans), spans - 1) + kDegree;
  Eigen::VectorXd values = Eigen::VectorXd::Zero(intervals);
  values[span] = 1.0;
  for (int d = 1; d <= degree; ++d) {
    for (int i = 0; i + d < intervals; ++i) {
      const double rise = Knot(i + d, spans) - Knot(i, spans);
      const double fall = Knot(i + d + 1, spans) - Knot(i + 1, spans);
      const double first = rise > 0.0 ? (place - Knot(i, spans)) / rise * values[i] : 0.0;
      const double second =
          fall > 0.0 ? (Knot(i + d + 1, spans) - place) / fall * values[i + 1] : 0.0;
      values[i] = first + second;
    }
  }
  return values.head(intervals - degree);
}

/// Derivative of the B-splines of `degree`, from the splines of one degree less.
Eigen::VectorXd Differentiate(const Eigen::VectorXd& lower, int degree, int spans) {
  Eigen::VectorXd values(lower.size() - 1);
  for (int i = 0; i < values.size(); ++i) {
    const double rise = Knot(i + degree, spans) - Knot(i, spans);
    const double fall = Knot(i + degree + 1, spans) - Knot(i + 1, spans);
    values[i] = (rise > 0.0 ? degree * lower[i] / rise : 0.0) -
                (fall > 0.0 ? degree * lower[i + 1] / fall : 0.0);
  }
  return values;
}

}  // namespace

Eigen::VectorXd QuinticSplineBasis(int control_points, double place, int derivative) {
  if (control_points <= kDegree)
    throw std::invalid_argument("a quintic needs at least six control points");
  if (derivative < 0 || derivative > 2)
    throw std::invalid_argument("the derivative must be 0, 1 or 2");
  const int spans = control_points - kDegree;
  Eigen::VectorXd values = Basis(kDegree - derivative, spans, std::clamp(place, 0.0, 1.0));
  for (int degree = kDegree - derivative + 1; degree <= kDegree; ++degree) {
    values = Differentiate(values, degree, spans);
  }
  return values;
}

Eigen::MatrixXd QuinticSplineBasisRows(int control_points, int samples, int derivative) {
  if (samples < 2) throw std::invalid_argument("a curve needs at least two samples");
  Eigen::MatrixXd rows(samples, control_points);
  for (int i = 0; i < samples; ++i) {
    const double place = i / static_cast<double>(samples - 1);
    rows.row(i) = QuinticSplineBasis(control_points, place, derivative).transpose();
  }
  return rows;
}

Eigen::MatrixXd RestToRestSpline(const Eigen::VectorXd& from, const Eigen::MatrixXd& way_points,
                                 const Eigen::VectorXd& to) {
  Eigen::MatrixXd control(way_points.rows() + 6, from.size());
  control.topRows(3).rowwise() = from.transpose();
  control.middleRows(3, way_points.rows()) = way_points;
  control.bottomRows(3).rowwise() = to.transpose();
  return control;
}

}  // namespace elastocal
