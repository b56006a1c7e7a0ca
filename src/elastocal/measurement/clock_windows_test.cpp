// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/clock_windows.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

UniformSpeed Waves(double start_s, int count, double lag_s, double gain, double offset) {
  UniformSpeed speed{start_s, 100.0, Eigen::VectorXd(count)};
  for (int i = 0; i < count; ++i) {
    const double t = start_s + 0.01 * i - lag_s;
    speed.values[i] = offset + gain * (std::sin(1.7 * t) + std::sin(2.9 * t + 1.0));
  }
  return speed;
}

TEST(FitWindowLag, FindsTheLagWhateverGainAndOffset) {
  const UniformSpeed measured = Waves(0.0, 2000, 0.2, 1.1, 0.3);
  const UniformSpeed predicted = Waves(-1.0, 2400, 0.0, 1.0, 0.0);
  const auto lag = FitWindowLag(measured, predicted, {0, 2000}, 0.1);
  ASSERT_TRUE(lag.has_value());
  EXPECT_NEAR(lag->lag_s, 0.2, 1e-5);  // error of interpolating waves of 200 samples
  EXPECT_NEAR(lag->time_s, 10.0, 1.0);
}

TEST(FitWindowLag, RefusesRestAndOtherMotion) {
  const UniformSpeed moving = Waves(0.0, 2000, 0.0, 1.0, 0.0);
  UniformSpeed rest = moving;
  rest.values.setConstant(0.1);
  UniformSpeed reversed = moving;
  reversed.values = -moving.values;
  const auto fails = [](const UniformSpeed& seen, const UniformSpeed& logged) {
    return !FitWindowLag(seen, logged, {0, 2000}, 0.0).has_value();
  };
  EXPECT_TRUE(fails(moving, rest));
  EXPECT_TRUE(fails(rest, moving));
  EXPECT_TRUE(fails(reversed, moving));
  EXPECT_TRUE(fails(moving, Waves(15.0, 500, 0.0, 1.0, 0.0)));
}

TEST(FitWindowLag, SettlesWhereAFrameAtTheRimComesAndGoes) {
  // With this frame, the best lag is one at which the frame has no counterpart. Without it, the
  // best lag is one at which the frame has one.
  constexpr int kRim = 500;
  UniformSpeed measured = Waves(0.0, 2000, 0.2, 1.0, 0.0);
  const double at_rim = measured.values[kRim];
  double start = 4.79;
  for (int i = 0; i < 3; ++i) {
    measured.values[kRim] = std::nan("");
    const auto without =
        FitWindowLag(measured, Waves(start, 2000, 0.0, 1.0, 0.0), {kRim, 2000}, 0.2);
    ASSERT_TRUE(without.has_value());
    start = 0.01 * (kRim - 1) - (without->lag_s + 1e-6);
  }
  for (const double error : {-0.02, 0.02}) {
    measured.values[kRim] = at_rim + error;
    const auto lag = FitWindowLag(measured, Waves(start, 2000, 0.0, 1.0, 0.0), {kRim, 2000}, 0.2);
    ASSERT_TRUE(lag.has_value()) << error;
    EXPECT_NEAR(lag->lag_s, 0.2, 1e-4);
  }
}

TEST(FitLine, IsNotMovedByOutliers) {
  Random random(6);
  std::vector<WindowLag> windows;
  for (int i = 0; i < 30; ++i) {
    const double t = 10.0 + 20.0 * i;
    windows.push_back({t, 4.0 - 50e-6 * t + random.Normal(2e-4), 2e-4, true});
  }
  for (const std::size_t i : {3u, 17u, 28u, 29u}) windows[i].lag_s += 0.2;
  const LagLine line = FitLine(windows);
  for (std::size_t i = 0; i < windows.size(); ++i) {
    EXPECT_EQ(windows[i].used, i != 3 && i != 17 && i < 28) << i;
  }
  EXPECT_NEAR(line.Lag(0.0), 4.0, 4.0 * line.Sd(0.0));
  EXPECT_NEAR(line.slope, -50e-6, 4.0 * line.slope_sd);
  // At the end of a line, the standard deviation is twice 2e-4 / sqrt(26). 30 windows tell the
  // scatter to a quarter.
  EXPECT_NEAR(line.Sd(0.0), 0.8e-4, 0.4e-4);
  EXPECT_NEAR(line.residual_s, 2e-4, 0.8e-4);
}

TEST(FitLine, IsNotRuledByWindowsThatClaimToBeSure) {
  // All windows have errors of 5 ms but claim standard deviations from 0.2 to 5 ms.
  Random random(9);
  double square = 0.0;
  double claimed = 0.0;
  for (int draw = 0; draw < 200; ++draw) {
    std::vector<WindowLag> windows;
    for (int i = 0; i < 30; ++i) {
      const double sd = 2e-4 * std::pow(25.0, random.Uniform(0.0, 1.0));
      windows.push_back({10.0 + 20.0 * i, 1.0 + random.Normal(5e-3), sd, true});
    }
    const LagLine line = FitLine(windows);
    square += std::pow(line.Lag(300.0) - 1.0, 2) / 200.0;
    claimed += std::pow(line.Sd(300.0), 2) / 200.0;
  }
  // The mean of 30 windows has a standard deviation of 0.91 ms. Robustness and uneven weights may
  // cost a quarter more.
  EXPECT_LT(std::sqrt(square), 1.15e-3);
  EXPECT_NEAR(std::sqrt(claimed / square), 1.0, 0.2);
}

}  // namespace
}  // namespace elastocal
