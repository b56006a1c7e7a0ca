// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/series_random.hpp"

#include <gtest/gtest.h>

#include "elastocal/simulation/stream_seed.hpp"

namespace elastocal {
namespace {

TEST(SeriesRandom, WithoutAShareEachRobotIsAsBefore) {
  SeriesRandom series(7, {.seed = 3, .share = 0.0}, "offset");
  Random plain(StreamSeed(7, "offset"));
  EXPECT_EQ(series.Normal(2.0), plain.Normal(2.0));
  EXPECT_EQ(series.NormalVector(3, 0.5), plain.NormalVector(3, 0.5));
  EXPECT_EQ(series.Uniform(1.0, 4.0), plain.Uniform(1.0, 4.0));
}

TEST(SeriesRandom, WithTheWholeShareRobotsAreEqualAndSeriesDiffer) {
  const auto draw = [](std::uint64_t robot, int series) {
    SeriesRandom random(robot, {.seed = series, .share = 1.0}, "offset");
    return std::pair{random.Normal(1.0), random.Uniform(0.0, 1.0)};
  };
  EXPECT_EQ(draw(1, 5), draw(2, 5));
  EXPECT_NE(draw(1, 5), draw(1, 6));
}

// Moments over 40000 robots. Four standard errors are 3 % for a variance and 2 % for a correlation.
TEST(SeriesRandom, TheShareIsOfTheVariance) {
  constexpr int kRobots = 40000;
  double mean = 0.0, squares = 0.0, uniform = 0.0, uniform_squares = 0.0;
  for (int robot = 0; robot < kRobots; ++robot) {
    SeriesRandom random(static_cast<std::uint64_t>(robot), {.seed = 9, .share = 0.8}, "offset");
    const double x = random.Normal(1.0);
    mean += x / kRobots;
    squares += x * x / kRobots;
  }
  EXPECT_NEAR(squares - mean * mean, 0.2, 0.006);
  // Over many series, the variance is the whole one, and uniform numbers are uniform.
  squares = 0.0;
  for (int series = 0; series < kRobots; ++series) {
    SeriesRandom random(static_cast<std::uint64_t>(series), {.seed = series, .share = 0.8}, "x");
    const double x = random.Normal(1.0), u = random.Uniform(2.0, 4.0);
    squares += x * x / kRobots;
    uniform += u / kRobots;
    uniform_squares += (u - 3.0) * (u - 3.0) / kRobots;
    EXPECT_TRUE(u >= 2.0 && u <= 4.0);
  }
  EXPECT_NEAR(squares, 1.0, 0.03);
  EXPECT_NEAR(uniform, 3.0, 0.012);
  EXPECT_NEAR(uniform_squares, 1.0 / 3.0, 0.006);
}

}  // namespace
}  // namespace elastocal
