// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/signal_excerpt.hpp"

#include <algorithm>
#include <limits>

namespace elastocal {
namespace {

std::vector<double> Column(const Eigen::MatrixXd& positions, Eigen::Index column) {
  const auto values = positions.col(column);
  return {values.begin(), values.end()};
}

/// Range of a column: its largest less its smallest number; NaN is skipped.
double Range(const Eigen::MatrixXd& positions, Eigen::Index column) {
  double least = std::numeric_limits<double>::infinity();
  double most = -least;
  for (const double x : positions.col(column)) {
    if (!(x < least || x > most)) continue;  // also NaN
    least = std::min(least, x);
    most = std::max(most, x);
  }
  return std::max(0.0, most - least);
}

}  // namespace

SignalExcerpt TakeExcerpt(const MarkerTrajectories& raw) {
  SignalExcerpt excerpt;
  double widest = -1.0;
  for (Eigen::Index column = 0; column < raw.positions.cols(); ++column) {
    const double range = Range(raw.positions, column);
    if (range <= widest) continue;
    widest = range;
    excerpt.marker = raw.names[static_cast<std::size_t>(column / 3)];
    excerpt.axis = static_cast<int>(column % 3);
    excerpt.raw = Column(raw.positions, column);
  }
  return excerpt;
}

void AddFiltered(const MarkerTrajectories& filtered, SignalExcerpt& excerpt) {
  const auto found = std::find(filtered.names.begin(), filtered.names.end(), excerpt.marker);
  if (found == filtered.names.end()) return;
  excerpt.filtered =
      Column(filtered.positions, 3 * (found - filtered.names.begin()) + excerpt.axis);
}

}  // namespace elastocal
