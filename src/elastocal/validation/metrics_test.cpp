// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/metrics.hpp"

#include <cmath>

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace elastocal
