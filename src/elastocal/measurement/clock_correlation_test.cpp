// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/clock_correlation.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

// A bump of height 1 and standard deviation 0.5 s at t = 0.
double Bump(double t) { return std::exp(-t * t / (2.0 * 0.25)); }

UniformSpeed Bumps(double start_s, int count, double first, double second, double height) {
  UniformSpeed speed{start_s, 100.0, Eigen::VectorXd(count)};
  for (int i = 0; i < count; ++i) {
    const double t = start_s + 0.01 * i;
    speed.values[i] = Bump(t - first) + height * Bump(t - second);
  }
  return speed;
}

TEST(Resample, InterpolatesAndLeavesHolesOpen) {
  PredictedSpeed predicted;
  predicted.time_s = Eigen::VectorXd(4);
  predicted.time_s << 2.0, 2.05, 2.10, 2.40;
  predicted.values = Eigen::VectorXd(4);
  predicted.values << 0.0, 1.0, 3.0, 4.0;
  const UniformSpeed speed = Resample(predicted, 40.0);
  ASSERT_EQ(speed.values.size(), 17);
  EXPECT_EQ(speed.start_s, 2.0);
  EXPECT_NEAR(speed.values[1], 0.5, 1e-9);
  EXPECT_NEAR(speed.values[3], 2.0, 1e-9);
  for (int k = 5; k < 16; ++k) EXPECT_TRUE(std::isnan(speed.values[k])) << k;
}

TEST(Correlate, FindsBothPeaks) {
  // Bumps at 10 and 15 s, of which the second is half as high. A shift by 5 s puts a high one on a
  // low one.
  const UniformSpeed measured = Bumps(0.0, 4000, 10.0, 15.0, 0.5);
  const UniformSpeed predicted = Bumps(100.0, 4000, 107.23, 112.23, 0.5);
  const CorrelationPeaks peaks = Correlate(measured, predicted, {.expected_lag_s = -100.0});
  ASSERT_TRUE(peaks.overlap);
  EXPECT_NEAR(peaks.lag_s, -97.23, 0.005);  // the top of a parabola through steps of 0.05 s
  EXPECT_NEAR(peaks.peak, 1.0, 2e-3);
  // The shift keeps 0.5 of the energy 1 + 0.25, which is 0.4. Subtracting the means makes it less.
  EXPECT_NEAR(peaks.second_peak, 0.35, 0.05);
  EXPECT_FALSE(peaks.at_the_rim);
}

TEST(Correlate, SeesTheRimAndTheLackOfOverlap) {
  const UniformSpeed measured = Bumps(0.0, 4000, 20.0, 27.0, 0.3);
  const UniformSpeed predicted = Bumps(0.0, 4000, 16.0, 23.0, 0.3);
  EXPECT_FALSE(Correlate(measured, predicted, {.longest_lag_s = 5.0}).at_the_rim);
  EXPECT_TRUE(Correlate(measured, predicted, {.longest_lag_s = 3.9}).at_the_rim);
  EXPECT_FALSE(Correlate(measured, predicted, {.expected_lag_s = 200.0}).overlap);
}

}  // namespace
}  // namespace elastocal
