// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/metrics.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

TEST(Metrics, HandValues) {
  Eigen::MatrixXd distances(2, 2);
  distances << 3.0, 100.0, 4.0, 12.0;
  ObservationMask mask(2, 2);
  mask << true, false, true, true;
  const ErrorMetrics metrics = ComputeMetrics(distances, mask);
  EXPECT_EQ(metrics.observations, 3);
  EXPECT_DOUBLE_EQ(metrics.rmse_3d, 13.0 / std::sqrt(3.0));  // 9 + 16 + 144 = 13^2
  EXPECT_DOUBLE_EQ(metrics.rmse_coordinate, 13.0 / 3.0);
  EXPECT_EQ(metrics.maximum, 12.0);
  EXPECT_DOUBLE_EQ(metrics.marker_rmse_3d[0], std::sqrt(12.5));
  EXPECT_DOUBLE_EQ(metrics.marker_rmse_3d[1], 12.0);
}

TEST(Metrics, NothingObservedIsNotZeroError) {
  const ErrorMetrics metrics =
      ComputeMetrics(Eigen::MatrixXd::Ones(2, 1), ObservationMask::Constant(2, 1, false));
  EXPECT_EQ(metrics.observations, 0);
  EXPECT_TRUE(std::isnan(metrics.rmse_3d));
  EXPECT_TRUE(std::isnan(metrics.marker_rmse_3d[0]));
}

// The squares are 1 and 9 in turn. Their mean is 5, whose standard deviation over ten units is
// sqrt(160 / 9 / 10) = 4 / 3. Student's t with 9 degrees of freedom is 2.262 (tables).
TEST(RmseInterval, HandValues) {
  Eigen::MatrixXd distances(10, 1);
  std::vector<int> unit_of;
  for (int i = 0; i < 10; ++i) {
    distances(i, 0) = i % 2 == 0 ? 1.0 : 3.0;
    unit_of.push_back(i);
  }
  const auto interval = IntervalOfRmse(distances, unit_of);
  ASSERT_TRUE(interval);
  const double half = 0.5 * 2.262 * (4.0 / 3.0) / 5.0;
  EXPECT_NEAR(interval->low, std::sqrt(5.0) * std::exp(-half), 1e-3);
  EXPECT_NEAR(interval->high, std::sqrt(5.0) * std::exp(half), 1e-3);
  EXPECT_FALSE(IntervalOfRmse(distances.topRows(4), {0, 1, 2, 3}));
}

// Each of 24 postures is measured three times and has one error, seen by two markers of a hand. 95
// % of the intervals contain the RMSE of all such postures. If the 72 rows counted as independent,
// fewer would. The share over 1000 draws has a standard deviation of 0.7 %. Squares of three
// coordinates are skew, which costs some 2 %.
TEST(RmseInterval, HoldsTheErrorOfOtherPosturesOfItsKind) {
  Random random(5);
  constexpr int kDraws = 1000, kUnits = 24, kRows = 3 * kUnits;
  int inside = 0, inside_as_independent = 0;
  std::vector<int> unit_of(kRows), row(kRows);
  for (int i = 0; i < kRows; ++i) {
    unit_of[static_cast<std::size_t>(i)] = i / 3;
    row[static_cast<std::size_t>(i)] = i;
  }
  const auto holds = [](const std::optional<RmseInterval>& interval) {
    return interval && interval->low < std::sqrt(3.0) && std::sqrt(3.0) < interval->high ? 1 : 0;
  };
  for (int draw = 0; draw < kDraws; ++draw) {
    Eigen::MatrixXd distances(kRows, 2);
    for (int unit = 0; unit < kUnits; ++unit) {
      Eigen::Vector3d error;
      for (double& coordinate : error) coordinate = random.Normal(1.0);
      distances.middleRows(3 * unit, 3).setConstant(error.norm());
    }
    inside += holds(IntervalOfRmse(distances, unit_of));
    inside_as_independent += holds(IntervalOfRmse(distances, row));
  }
  EXPECT_GT(inside, 0.92 * kDraws);
  EXPECT_LT(inside, 0.97 * kDraws);
  EXPECT_LT(inside_as_independent, 0.8 * kDraws);
}

}  // namespace
}  // namespace elastocal
