// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/bspline.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

TEST(QuinticSpline, WithSixControlPointsIsBernstein) {
  // Without inner knots, the basis is that of Bezier curves: C(5, i) u^i (1 - u)^(5 - i).
  const double u = 0.3, v = 0.7;
  Eigen::VectorXd expected(6);
  expected << v * v * v * v * v, 5 * u * v * v * v * v, 10 * u * u * v * v * v,
      10 * u * u * u * v * v, 5 * u * u * u * u * v, u * u * u * u * u;
  EXPECT_LT((QuinticSplineBasis(6, u) - expected).norm(), 1e-15);
}

TEST(QuinticSpline, SumsToOneAndIsNeverNegative) {
  for (int points = 6; points < 14; ++points) {
    const Eigen::MatrixXd rows = QuinticSplineBasisRows(points, 101);
    EXPECT_LT((rows.rowwise().sum().array() - 1.0).abs().maxCoeff(), 1e-14) << points;
    EXPECT_GE(rows.minCoeff(), 0.0) << points;
  }
}

TEST(QuinticSpline, DerivativesAreDifferences) {
  const double step = 1e-4;
  for (const double place : {0.02, 0.31, 0.5, 0.77, 0.98}) {
    const Eigen::VectorXd before = QuinticSplineBasis(11, place - step);
    const Eigen::VectorXd at = QuinticSplineBasis(11, place);
    const Eigen::VectorXd after = QuinticSplineBasis(11, place + step);
    // Truncation is 1e5 step^2 / 6, because the third and fourth derivatives reach 1e5. Rounding is
    // 1e-16 / step^2.
    EXPECT_LT(((after - before) / (2 * step) - QuinticSplineBasis(11, place, 1)).norm(), 1e-3);
    EXPECT_LT(((after - 2 * at + before) / (step * step) - QuinticSplineBasis(11, place, 2)).norm(),
              1e-2);
  }
}

TEST(QuinticSpline, RestsAtBothEnds) {
  Random random(1);
  const Eigen::VectorXd from = random.NormalVector(3, 1.0), to = random.NormalVector(3, 1.0);
  Eigen::MatrixXd way_points(5, 3);
  for (int i = 0; i < 5; ++i) way_points.row(i) = random.NormalVector(3, 1.0).transpose();
  const Eigen::MatrixXd control = RestToRestSpline(from, way_points, to);
  for (const double end : {0.0, 1.0}) {
    const Eigen::VectorXd value = control.transpose() * QuinticSplineBasis(11, end);
    EXPECT_EQ(value, end > 0.5 ? to : from);
    // The terms are differences of equal numbers. Their sums with factors of some hundred round to
    // 1e-13.
    EXPECT_LT((control.transpose() * QuinticSplineBasis(11, end, 1)).norm(), 1e-12);
    EXPECT_LT((control.transpose() * QuinticSplineBasis(11, end, 2)).norm(), 1e-11);
  }
}

TEST(QuinticSpline, RefusesWhatItCannotDo) {
  EXPECT_THROW(QuinticSplineBasis(5, 0.5), std::invalid_argument);
  EXPECT_THROW(QuinticSplineBasis(11, 0.5, 3), std::invalid_argument);
  EXPECT_THROW(QuinticSplineBasisRows(11, 1), std::invalid_argument);
}

}  // namespace
}  // namespace elastocal
