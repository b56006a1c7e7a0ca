// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/column_step.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

/// 50 positions over 5 rad without a common step.
Eigen::VectorXd Positions() {
  Eigen::VectorXd column(50);
  for (int i = 0; i < 50; ++i) column[i] = 2.5 * std::sin(1.0 + 37.0 * i * i);
  return column;
}

TEST(StepOf, IsThatOfARoundedColumnWhateverItsZeroAndDigits) {
  for (const double step : {M_PI / 180.0, 2.0 * M_PI / 1024.0, 0.01}) {
    Eigen::VectorXd column = ((Positions() / step).array().round() + 0.3) * step;
    EXPECT_NEAR(StepOf(column), step, 1e-9);
    column = (1e6 * column).array().round() / 1e6;
    EXPECT_NEAR(StepOf(column), step, 1e-6);
    column[7] += 0.4 * step;  // like the mean of two readings
    EXPECT_NEAR(StepOf(column), step, 1e-6);
  }
}

TEST(StepOf, IsNoneOfOtherColumns) {
  EXPECT_LT(StepOf(Positions()), 1e-4);
  EXPECT_EQ(StepOf(Eigen::VectorXd::LinSpaced(9, 0.0, 1.0)), 0.0);  // too few positions
}

}  // namespace
}  // namespace elastocal
