// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/stable_samples.hpp"

#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/measurement/gaps.hpp"

namespace elastocal {
namespace {

using Intervals = std::vector<FrameInterval>;

std::vector<int> AllOf(int count) {
  std::vector<int> markers(static_cast<std::size_t>(count));
  std::iota(markers.begin(), markers.end(), 0);
  return markers;
}

// Checks that every frame is either a sample or unused for exactly one reason.
void ExpectComplete(const StableSamples& samples, int frame_count) {
  std::vector<int> times(static_cast<std::size_t>(frame_count), 0);
  for (const int frame : samples.frames) ++times[static_cast<std::size_t>(frame)];
  for (const UnusedFrames& unused : samples.unused) {
    for (int i = unused.frames.begin; i < unused.frames.end; ++i)
      ++times[static_cast<std::size_t>(i)];
  }
  for (const int count : times) EXPECT_EQ(count, 1);
}

TEST(MarkerSpeeds, AreCentralDifferences) {
  MarkerTrajectories trajectories;
  trajectories.names = {"a", "b"};
  trajectories.rate_hz = 10.0;
  trajectories.positions.resize(6, 6);
  for (int i = 0; i < 6; ++i) trajectories.positions.row(i) << 0, 3.0 * i, 4.0 * i, i * i, 0, 0;
  trajectories.positions.block(3, 0, 1, 3).setConstant(kNaN);
  const Eigen::MatrixXd speeds = MarkerSpeeds(trajectories);
  ASSERT_EQ(speeds.rows(), 6);
  EXPECT_DOUBLE_EQ(speeds(1, 0), 50.0);
  EXPECT_DOUBLE_EQ(speeds(2, 1), 40.0);  // derivative of a parabola, exactly
  for (const int i : {0, 2, 3, 4, 5}) EXPECT_TRUE(std::isnan(speeds(i, 0))) << i;
  EXPECT_TRUE(std::isnan(speeds(0, 1)) && std::isnan(speeds(5, 1)));
}

TEST(FindStableSamples, FindsRunsAndSaysWhyOthersAreNot) {
  Eigen::MatrixXd speeds = Eigen::MatrixXd::Constant(100, 3, 0.001);
  speeds.block(20, 1, 10, 1).setConstant(0.1);   // moving
  speeds(25, 2) = 0.2;                           // the fastest frame of this motion
  speeds.block(35, 0, 5, 1).setConstant(0.05);   // leaves 30 to 34 at rest: too short
  speeds.block(60, 0, 10, 2).setConstant(kNaN);  // leaves one marker of three
  speeds.block(80, 2, 20, 1).setConstant(kNaN);  // leaves two markers of three
  const StableSamples samples = FindStableSamples(
      speeds, AllOf(3), 100.0, {.threshold_m_per_s = 0.01, .hold_s = 0.1, .samples_per_run = 2});
  EXPECT_EQ(samples.runs, (Intervals{{0, 20}, {40, 60}, {70, 100}}));
  // Samples are at the quarters of each run. In the last run, only the ten frames that show all
  // three markers count.
  EXPECT_EQ(samples.frames, (std::vector<int>{5, 15, 45, 55, 72, 77}));
  EXPECT_EQ(samples.run_of_frame, (std::vector<int>{0, 0, 1, 1, 2, 2}));
  EXPECT_EQ(samples.samples_of_marker, (std::vector<int>{6, 6, 6}));
  EXPECT_FALSE(samples.resting_speed_m_per_s.has_value());
  ExpectComplete(samples, 100);
  EXPECT_EQ(samples.UnusedCount(UnusedReason::kMoving), 15);
  EXPECT_EQ(samples.UnusedCount(UnusedReason::kTooShort), 5);
  EXPECT_EQ(samples.UnusedCount(UnusedReason::kTooFewVisible), 10);
  EXPECT_EQ(samples.UnusedCount(UnusedReason::kSpare), 64);
  for (const UnusedFrames& unused : samples.unused) {
    if (unused.frames == FrameInterval{20, 30}) {
      EXPECT_EQ(unused.fastest_marker, 2);
    }
  }
}

TEST(FindStableSamples, LooksAtTheGivenMarkersOnly) {
  Eigen::MatrixXd speeds = Eigen::MatrixXd::Constant(50, 2, 0.001);
  speeds.col(1).setConstant(1.0);
  const StableSampleOptions options{.threshold_m_per_s = 0.01, .samples_per_run = 1};
  EXPECT_EQ(FindStableSamples(speeds, {0}, 100.0, options).frames, (std::vector<int>{25}));
  EXPECT_TRUE(FindStableSamples(speeds, {0, 1}, 100.0, options).frames.empty());
}

TEST(FindStableSamples, TakesAllFramesOfARunThatHasFewer) {
  const Eigen::MatrixXd speeds = Eigen::MatrixXd::Constant(4, 1, 0.001);
  const StableSamples samples = FindStableSamples(
      speeds, {0}, 100.0, {.threshold_m_per_s = 0.01, .hold_s = 0.0, .samples_per_run = 9});
  EXPECT_EQ(samples.frames, (std::vector<int>{0, 1, 2, 3}));
}

// Positions of twelve markers with noise of 0.2 mm: a posture every 5 s, which ends with `rest_s`
// of rest.
MarkerTrajectories Postures(int count, double rest_s, double noise = 0.2e-3) {
  MarkerTrajectories trajectories;
  trajectories.names.resize(12, "m");
  trajectories.rate_hz = 100.0;
  const int frames = 500 * count;
  trajectories.positions.resize(frames, 36);
  Random random(3);
  for (int i = 0; i < frames; ++i) {
    // The motion has minimum jerk, like the paper's splines of 5th order.
    const double u = std::min(1.0, (i % 500) / (100.0 * (5.0 - rest_s)));
    const int passed = i / 500;  // motions
    const double way = passed + u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
    for (int k = 0; k < 36; ++k) {
      const double reach = k < 18 ? 0.0 : 0.4;  // half of the markers are on the base
      trajectories.positions(i, k) = reach * std::sin(way + k) + random.Normal(noise);
    }
  }
  return trajectories;
}

TEST(FindStableSamples, ChoosesItsThresholdFromTheData) {
  for (const std::vector<int>& markers : {AllOf(12), std::vector<int>{6, 7, 8, 9, 10, 11}}) {
    MarkerTrajectories trajectories = Postures(20, 1.0);
    SmoothTrajectories({}, trajectories);
    const StableSamples samples =
        FindStableSamples(MarkerSpeeds(trajectories), markers, 100.0, {.samples_per_run = 4});
    // White noise of s through a low-pass at f with rate r gives each axis a speed of variance (2
    // pi s)^2 2 f^3 / (3 r), so 1.15 mm/s here. The median length of three axes is 1.538 times
    // that.
    ASSERT_TRUE(samples.resting_speed_m_per_s.has_value());
    EXPECT_NEAR(*samples.resting_speed_m_per_s, 1.77e-3, 0.45e-3);
    EXPECT_FALSE(samples.threshold_limited);
    ASSERT_EQ(samples.runs.size(), 20u);
    EXPECT_EQ(samples.frames.size(), 80u);
    for (const int frame : samples.frames) {
      const int phase = frame % 500;  // the motion begins and ends slowly: 0.3 s count as rest
      EXPECT_TRUE(phase > 370 || phase < 30) << frame;
    }
    ExpectComplete(samples, 10000);
  }
}

TEST(FindStableSamples, TakesDataWithoutNoise) {
  MarkerTrajectories trajectories = Postures(5, 1.0, 0.0);
  SmoothTrajectories({}, trajectories);
  const StableSamples samples = FindStableSamples(MarkerSpeeds(trajectories), AllOf(12), 100.0, {});
  EXPECT_EQ(samples.threshold_m_per_s, 0.001);
  EXPECT_EQ(samples.runs.size(), 5u);
}

TEST(FindStableSamples, FindsNoneInAMotionWithoutRest) {
  MarkerTrajectories trajectories = Postures(4, 1.0);
  for (int i = 0; i < trajectories.frame_count(); ++i) {
    for (int k = 0; k < 36; ++k) {
      trajectories.positions(i, k) = 0.2 * std::sin(2.0 * std::numbers::pi * 0.5 * 0.01 * i + k);
    }
  }
  const StableSamples samples = FindStableSamples(MarkerSpeeds(trajectories), AllOf(12), 100.0, {});
  EXPECT_TRUE(samples.frames.empty());
  EXPECT_TRUE(samples.threshold_limited);
  EXPECT_EQ(samples.threshold_m_per_s, 0.02);
  EXPECT_EQ(samples.UnusedCount(UnusedReason::kMoving), 1998);
}

TEST(FindStableSamples, RefusesWrongArguments) {
  const Eigen::MatrixXd speeds = Eigen::MatrixXd::Zero(10, 2);
  EXPECT_THROW(FindStableSamples(speeds, {}, 100.0, {}), std::invalid_argument);
  EXPECT_THROW(FindStableSamples(speeds, {2}, 100.0, {}), std::invalid_argument);
  EXPECT_THROW(FindStableSamples(speeds, {0}, 0.0, {}), std::invalid_argument);
  EXPECT_THROW(FindStableSamples(speeds, {0}, 100.0, {.samples_per_run = 0}),
               std::invalid_argument);
}

}  // namespace
}  // namespace elastocal
