// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/lag_change.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

constexpr double kScoreBlock_s = 2.0;

// Position of a marker at the end of two turning levers, of which the first has this length.
Eigen::Vector3d LeverPosition(double time_s, double phase, double length_m) {
  const double a = 0.9 * std::sin(0.7 * time_s + phase);
  const double b = 0.7 * std::sin(1.1 * time_s - phase);
  return length_m * Eigen::Vector3d(std::cos(a), std::sin(a), 0.0) +
         0.3 * Eigen::Vector3d(std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b));
}

struct PlayedLevers {
  int markers = 3;
  double duration_s = 60.0;
  double level_s = 0.004;  // lag change at time 0, to be found
  double slope = 0.0;
  double too_long_m = 0.0;  // error of the predicted length of the first lever
  bool with_shapes = false;
  double noise_m = 0.2e-3;
  std::uint64_t seed = 1;
};

MarkerMotion PlayLevers(const PlayedLevers& played) {
  Random random(played.seed);
  const auto count = static_cast<Eigen::Index>(10.0 * played.duration_s);
  MarkerMotion motion;
  motion.time_s = Eigen::VectorXd::LinSpaced(count, 0.0, 0.1 * static_cast<double>(count - 1));
  const Eigen::Index columns = 3 * played.markers;
  motion.predicted.resize(count, columns);
  motion.measured.resize(count, columns);
  motion.velocity.resize(count, columns);
  motion.shapes.resize(Size(played.markers));
  if (played.with_shapes) motion.prior_sd = Eigen::VectorXd::Constant(1, 0.05);
  for (int m = 0; m < played.markers; ++m) {
    MarkerMotion::Shapes& shapes = motion.shapes[Size(m)];
    shapes.derivatives.resize(3 * count, played.with_shapes ? 1 : 0);
    if (played.with_shapes) shapes.unknowns = {0};
    for (Eigen::Index i = 0; i < count; ++i) {
      const double time_s = motion.time_s[i];
      const double late_s = time_s - played.level_s - played.slope * time_s;
      const auto at = [&](double when_s, double length_m) {
        return LeverPosition(when_s, 0.4 * m, length_m);
      };
      motion.predicted.block<1, 3>(i, 3 * m) = at(time_s, 0.4).transpose();
      motion.velocity.block<1, 3>(i, 3 * m) =
          ((at(time_s + 1e-4, 0.4) - at(time_s - 1e-4, 0.4)) / 2e-4).transpose();
      motion.measured.block<1, 3>(i, 3 * m) =
          (at(late_s, 0.4 + played.too_long_m) + random.NormalVector(3, played.noise_m))
              .transpose();
      if (played.with_shapes) {
        shapes.derivatives.col(0).segment<3>(3 * i) = at(time_s, 1.0) - at(time_s, 0.0);
      }
    }
  }
  return motion;
}

TEST(FindLagChange, FindsLevelAndSlopeWithoutNoise) {
  const auto change = FindLagChange(PlayLevers({.level_s = 1e-4, .slope = 2e-6, .noise_m = 0.0}),
                                    true, kScoreBlock_s);
  ASSERT_TRUE(change);
  // The error is of second order in the lag change: 0.5 m/s^2 times its square.
  EXPECT_NEAR(change->At(0.0), 1e-4, 1e-7);
  EXPECT_NEAR(change->At(60.0), 2.2e-4, 1e-7);
  EXPECT_NEAR(change->slope, 2e-6, 2e-9);
}

TEST(FindLagChange, TakesNoSlopeThatIsNotAskedFor) {
  const auto change = FindLagChange(PlayLevers({}), false, kScoreBlock_s);
  ASSERT_TRUE(change);
  EXPECT_EQ(change->slope, 0.0);
  EXPECT_EQ(change->slope_sd, 0.0);
  EXPECT_NEAR(change->level_s, 0.004, 5e-5);
}

// Over sixty recordings, the errors must be as large as their standard deviations say.
TEST(FindLagChange, KnowsHowFarNoiseThrowsItOff) {
  double squares = 0.0;
  for (int seed = 1; seed <= 60; ++seed) {
    const auto change = FindLagChange(
        PlayLevers({.level_s = 1e-4, .noise_m = 1e-3, .seed = static_cast<std::uint64_t>(seed)}),
        true, kScoreBlock_s);
    ASSERT_TRUE(change);
    squares += std::pow((change->At(30.0) - 1e-4) / change->Sd(30.0), 2) / 60.0;
  }
  // Mean of sixty squares with about 28 degrees of freedom: 1.07 +- 0.2.
  EXPECT_GT(squares, 0.55);
  EXPECT_LT(squares, 1.75);
}

// A lever that is longer than predicted moves the markers in step with it, here by 20 mm.
TEST(FindLagChange, TakesShapesForWhatTheyAre) {
  const PlayedLevers longer{.level_s = 0.001, .too_long_m = 0.02, .noise_m = 0.02e-3};
  const auto without = FindLagChange(PlayLevers(longer), false, kScoreBlock_s);
  PlayedLevers known = longer;
  known.with_shapes = true;
  const auto with = FindLagChange(PlayLevers(known), false, kScoreBlock_s);
  ASSERT_TRUE(without && with);
  EXPECT_NEAR(with->level_s, 0.001, 5e-5);
  EXPECT_LT(with->level_sd_s, 0.05 * without->level_sd_s);
}

TEST(FindLagChange, LeavesOutMarkersThatGoTheirOwnWay) {
  MarkerMotion motion = PlayLevers({});
  motion.measured.middleCols<3>(3).colwise().reverseInPlace();  // the second one, in reverse
  const auto change = FindLagChange(motion, false, kScoreBlock_s);
  ASSERT_TRUE(change);
  EXPECT_NEAR(change->level_s, 0.004, 1e-4);
}

TEST(FindLagChange, LeavesOutWhatIsNotSeen) {
  MarkerMotion motion = PlayLevers({});
  motion.measured.block(100, 0, 200, 9).setConstant(kNaN);
  const auto change = FindLagChange(motion, false, kScoreBlock_s);
  ASSERT_TRUE(change);
  EXPECT_NEAR(change->level_s, 0.004, 1e-4);
}

TEST(FindLagChange, SaysNothingWhereLittleIsKnown) {
  EXPECT_FALSE(FindLagChange(PlayLevers({.duration_s = 15.0}), false, kScoreBlock_s));
  MarkerMotion still = PlayLevers({});
  still.predicted.rowwise() = still.predicted.row(0).eval();
  still.velocity.setZero();
  EXPECT_FALSE(FindLagChange(still, false, kScoreBlock_s));
  EXPECT_FALSE(FindLagChange(MarkerMotion{}, false, kScoreBlock_s));
}

}  // namespace
}  // namespace elastocal
