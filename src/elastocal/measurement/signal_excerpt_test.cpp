// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/signal_excerpt.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

TEST(SignalExcerpt, TakesTheCoordinateThatRangesMost) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  MarkerTrajectories raw{"", {"A", "B"}, 100.0, Eigen::MatrixXd::Zero(3, 6)};
  raw.positions.col(1) << 0.0, 0.1, 0.2;
  raw.positions.col(5) << 1.0, nan, 0.5;  // z of B ranges over 0.5, although one frame is missing
  SignalExcerpt excerpt = TakeExcerpt(raw);
  EXPECT_EQ(excerpt.marker, "B");
  EXPECT_EQ(excerpt.axis, 2);
  ASSERT_EQ(excerpt.raw.size(), 3u);
  EXPECT_EQ(excerpt.raw[0], 1.0);
  EXPECT_TRUE(std::isnan(excerpt.raw[1]));

  MarkerTrajectories filtered = raw;
  filtered.positions.col(5) << 0.9, 0.7, 0.6;
  AddFiltered(filtered, excerpt);
  EXPECT_EQ(excerpt.filtered, (std::vector<double>{0.9, 0.7, 0.6}));
}

TEST(SignalExcerpt, IsEmptyWithoutMarkers) {
  EXPECT_TRUE(TakeExcerpt({"", {}, 100.0, Eigen::MatrixXd(3, 0)}).marker.empty());
}

}  // namespace
}  // namespace elastocal
