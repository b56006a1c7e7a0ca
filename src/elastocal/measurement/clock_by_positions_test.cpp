// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/clock_by_positions.hpp"

#include <cmath>
#include <functional>
#include <numeric>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/measurement/stable_samples.hpp"
#include "elastocal/measurement/trial_clock.hpp"
#include "tests/test_robots.hpp"
#include "tests/trial_player.hpp"

namespace elastocal {
namespace {

constexpr double kPlayedLag_s = 0.8;
constexpr double kPlayedDrift_ppm = 30.0;

// The leg as it is built: each joint is off by a degree and some millimetres.
MarkedRobot LegAsBuilt(std::uint64_t seed) {
  MarkedRobot robot = MarkedTalosLeg();
  Random random(seed);
  for (Joint& joint : robot.tree.joints) {
    const Eigen::Vector3d turn = random.NormalVector(3, 0.015);
    const Eigen::Vector3d shift = random.NormalVector(3, 0.003);
    joint.T_parent_child = joint.T_parent_child * FromXyzRpy(shift, turn);
  }
  for (Marker& marker : robot.markers) marker.p_link_marker += random.NormalVector(3, 0.005);
  return robot;
}

struct ToldClocks {
  ClockFit by_speed, by_positions;
};

using Change = std::function<void(ClockFit&)>;

// Plays slow motions between postures while the foot stands. `change` alters the clock that the
// speeds tell.
ToldClocks Tell(const MarkedRobot& built, PlayOptions options, const ClockOptions& clock = {},
                const Change& change = {}) {
  options.standing = 6;
  const ScriptedTrial played = Play(built, options);
  MarkerTrajectories markers = played.markers;
  SmoothTrajectories({}, markers);
  const MarkedRobot nominal = MarkedTalosLeg();
  std::vector<int> all(nominal.markers.size());
  std::iota(all.begin(), all.end(), 0);
  const std::vector<int> coordinates = {0, 1, 2, 3, 4, 5};
  const SmoothedLog log = SmoothLog(played.log, {});
  const LoggedSpeeds logged =
      PredictSpeeds(nominal, all, {options.standing}, log, coordinates, 100.0);
  ToldClocks clocks;
  clocks.by_speed = EstimateTrialClock(MarkerSpeeds(markers), 100.0, logged, {}, clock);
  if (change) change(clocks.by_speed);
  clocks.by_positions = RefineClock(nominal, all, {options.standing}, log, coordinates, markers,
                                    clocks.by_speed, clock);
  return clocks;
}

PlayOptions SlowMotion(std::uint64_t seed) {
  return {.postures = 16,
          .move_s = 5.0,
          .rest_s = 0.2,
          .lag_s = kPlayedLag_s,
          .drift_ppm = kPlayedDrift_ppm,
          .seed = seed};
}

// Errors of the robot shift the clock that speeds tell by milliseconds.
TEST(RefineClockStudy, IsHardlyDisturbedByErrorsOfTheRobot) {
  double by_speed = 0.0;
  double by_positions = 0.0;
  double standardised = 0.0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const ToldClocks clocks = Tell(LegAsBuilt(seed), SlowMotion(seed));
    const auto error = [](const ClockFit& fit) {
      return std::pow(
                 fit.CameraTime(40.0) - (40.0 + kPlayedLag_s) / (1.0 + 1e-6 * kPlayedDrift_ppm),
                 2) /
             6.0;
    };
    by_speed += error(clocks.by_speed);
    by_positions += error(clocks.by_positions);
    standardised += error(clocks.by_positions) / std::pow(clocks.by_positions.sd_s, 2);
    EXPECT_EQ(clocks.by_positions.state, ClockState::kReliable) << seed;
    EXPECT_NEAR(clocks.by_positions.drift_ppm, kPlayedDrift_ppm, 10.0) << seed;
  }
  EXPECT_LT(std::sqrt(by_positions), 0.2e-3);
  EXPECT_LT(std::sqrt(by_positions), 0.2 * std::sqrt(by_speed));
  EXPECT_LT(standardised, 4.0);
}

TEST(RefineClock, IsExactForTheNominalRobot) {
  PlayOptions options = SlowMotion(3);
  options.marker_sd = 0.0;
  const ToldClocks clocks = Tell(MarkedTalosLeg(), options);
  EXPECT_NEAR(clocks.by_positions.lag_s, kPlayedLag_s, 5e-5);
}

TEST(RefineClock, JudgesByTheSameBound) {
  const ToldClocks clocks = Tell(LegAsBuilt(1), SlowMotion(1), {.largest_sd_s = 1e-7});
  EXPECT_LT(clocks.by_positions.sd_s, clocks.by_speed.sd_s);
  EXPECT_EQ(clocks.by_positions.state, ClockState::kImprecise);
}

// Speeds leave two lags to choose from, of which the first is wrong by five seconds.
TEST(RefineClock, ChoosesOfTwoLags) {
  const ToldClocks clocks = Tell(LegAsBuilt(2), SlowMotion(2), {}, [](ClockFit& clock) {
    clock.state = ClockState::kAmbiguous;
    clock.second_lag_s = clock.lag_s;
    clock.lag_s += 5.2;
  });
  EXPECT_EQ(clocks.by_positions.state, ClockState::kReliable);
  EXPECT_NEAR(clocks.by_positions.lag_s, kPlayedLag_s, 2e-3);
}

TEST(RefineClock, DoesNotChooseBetweenLagsThatAreAlike) {
  const ToldClocks clocks = Tell(LegAsBuilt(2), SlowMotion(2), {}, [](ClockFit& clock) {
    clock.state = ClockState::kAmbiguous;
    clock.second_lag_s = clock.lag_s;
  });
  EXPECT_EQ(clocks.by_positions.state, ClockState::kAmbiguous);
}

// Three postures give too little data to estimate the scatter.
TEST(RefineClock, LeavesAShortTrialAsItWas) {
  PlayOptions options = SlowMotion(1);
  options.postures = 4;
  const ToldClocks clocks = Tell(LegAsBuilt(1), options);
  EXPECT_EQ(clocks.by_positions.lag_s, clocks.by_speed.lag_s);
  EXPECT_EQ(clocks.by_positions.sd_s, clocks.by_speed.sd_s);
}

}  // namespace
}  // namespace elastocal
