// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/gaps.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/measurement/frame_interval.hpp"

namespace elastocal {
namespace {

using Intervals = std::vector<FrameInterval>;

// Two markers at 100 Hz whose positions are cubic in time.
MarkerTrajectories CubicMotion(int frames) {
  MarkerTrajectories trajectories{
      .source = "", .names = {"a", "b"}, .rate_hz = 100.0, .positions = {}};
  trajectories.positions.resize(frames, 6);
  for (int frame = 0; frame < frames; ++frame) {
    const double t = 0.01 * frame;
    trajectories.positions.row(frame) << 1.0 + t, t * t - t, 0.3 * t * t * t, 2.0, -t, t * t;
  }
  return trajectories;
}

void Hide(MarkerTrajectories& trajectories, int marker, FrameInterval gap) {
  trajectories.positions.block(gap.begin, 3 * marker, gap.size(), 3).setConstant(kNaN);
}

TEST(FillGaps, ReproducesACubicUpToTheLongestGap) {
  const MarkerTrajectories truth = CubicMotion(200);
  MarkerTrajectories seen = truth;
  Hide(seen, 0, {50, 70});  // 0.2 s, the longest allowed
  Hide(seen, 0, {100, 101});
  Hide(seen, 1, {120, 141});  // one frame longer
  Hide(seen, 1, {0, 3});      // no frames before it
  Hide(seen, 1, {198, 200});
  const auto reports = FillGaps(0.2, seen);
  ASSERT_EQ(reports.size(), 2u);
  EXPECT_EQ(reports[0].frames_seen, 179);
  EXPECT_EQ(reports[0].filled, (Intervals{{50, 70}, {100, 101}}));
  EXPECT_TRUE(reports[0].open.empty());
  EXPECT_TRUE(reports[1].filled.empty());
  EXPECT_EQ(reports[1].open, (Intervals{{0, 3}, {120, 141}, {198, 200}}));
  // The tolerance covers rounding in the normal equations.
  EXPECT_LT((seen.positions - truth.positions).leftCols(3).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_FALSE(Seen(seen, 130, 1));
  EXPECT_TRUE(Seen(seen, 119, 1));
}

TEST(FillGaps, ZeroFillsNothingAndALonelyFrameIsNoNeighbour) {
  MarkerTrajectories seen = CubicMotion(60);
  Hide(seen, 0, {30, 31});
  EXPECT_EQ(FillGaps(0.0, seen)[0].open, (Intervals{{30, 31}}));
  Hide(seen, 0, {10, 29});  // leaves frame 29 alone before the gap at 30
  const auto reports = FillGaps(0.2, seen);
  EXPECT_EQ(reports[0].filled, (Intervals{{10, 29}}));
  EXPECT_EQ(reports[0].open, (Intervals{{30, 31}}));
}

TEST(FillGaps, AveragesTheNoiseOfTheNeighbours) {
  const MarkerTrajectories truth = CubicMotion(4000);
  MarkerTrajectories seen = truth;
  Random random(7);
  for (double& value : seen.positions.reshaped()) value += random.Normal(0.2e-3);
  Intervals gaps;
  for (int begin = 20; begin < 3960; begin += 40) gaps.push_back({begin, begin + 10});
  for (const FrameInterval& gap : gaps) Hide(seen, 0, gap);
  EXPECT_EQ(FillGaps(0.2, seen)[0].filled, gaps);
  double sum = 0.0;
  for (const FrameInterval& gap : gaps) {
    sum += (seen.positions - truth.positions).block(gap.begin, 0, gap.size(), 3).squaredNorm();
  }
  // In the middle, the cubic through ten frames on either side has about 0.6 of the noise of one
  // frame.
  EXPECT_LT(std::sqrt(sum / (3.0 * FrameCount(gaps))), 0.2e-3);
}

TEST(SmoothTrajectories, FiltersEachPieceForItself) {
  MarkerTrajectories seen = CubicMotion(500);
  Random random(8);
  for (double& value : seen.positions.reshaped()) value += random.Normal(0.2e-3);
  Hide(seen, 0, {50, 60});    // is filled
  Hide(seen, 0, {200, 300});  // stays open
  Hide(seen, 0, {318, 400});  // leaves 18 frames, one too few
  MarkerTrajectories piece = seen;
  const auto reports = SmoothTrajectories({}, seen);
  EXPECT_EQ(reports[0].filled, (Intervals{{50, 60}}));
  EXPECT_EQ(reports[0].open, (Intervals{{200, 300}, {318, 400}}));
  EXPECT_EQ(reports[0].dropped, (Intervals{{300, 318}}));
  EXPECT_TRUE(reports[1].dropped.empty());
  for (int frame = 200; frame < 400; ++frame) EXPECT_FALSE(Seen(seen, frame, 0)) << frame;

  // The last piece is the same as if it is filtered alone: what lies before it does not matter.
  Eigen::MatrixXd alone = piece.positions.block(400, 0, 100, 3);
  FiltFilt(ButterworthLowPass(5, 5.0, 100.0), alone);
  EXPECT_EQ(seen.positions.block(400, 0, 100, 3), alone);
}

TEST(SmoothTrajectories, TakesAwayNoiseButNotMotion) {
  MarkerTrajectories seen{.source = "", .names = {"a"}, .rate_hz = 100.0, .positions = {}};
  const auto position = [](int frame) {
    return 0.1 * std::sin(2.0 * std::numbers::pi * 0.5 * 0.01 * frame);
  };
  seen.positions.resize(2000, 3);
  Random random(9);
  for (int frame = 0; frame < 2000; ++frame) {
    for (int k = 0; k < 3; ++k) seen.positions(frame, k) = position(frame) + random.Normal(0.2e-3);
  }
  SmoothTrajectories({}, seen);
  double sum = 0.0;
  for (int frame = 100; frame < 1900; ++frame) {
    sum += (seen.positions.row(frame).array() - position(frame)).square().sum();
  }
  // A tenth of the noise power lies below 5 Hz: 0.2 mm / sqrt(10) = 0.063 mm, known to 5 %.
  EXPECT_NEAR(std::sqrt(sum / 5400.0), 0.063e-3, 0.006e-3);
}

TEST(SmoothTrajectories, RefusesACutoffAboveHalfTheRate) {
  MarkerTrajectories seen = CubicMotion(50);
  EXPECT_THROW(SmoothTrajectories({.cutoff_hz = 60.0}, seen), std::invalid_argument);
}

}  // namespace
}  // namespace elastocal
