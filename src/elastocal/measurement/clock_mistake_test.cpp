// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/clock_mistake.hpp"

#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "elastocal/measurement/stable_samples.hpp"
#include "tests/test_robots.hpp"
#include "tests/trial_player.hpp"

namespace elastocal {
namespace {

/// Records a leg in ten postures for 50 s. `change` spoils its log, for instance the times.
class ClockMistakes : public testing::Test {
 protected:
  static std::optional<ClockMistake> Find(const std::function<void(JointLog&)>& change,
                                          int postures = 10, std::uint64_t seed = 1) {
    const MarkedRobot robot = MarkedTalosLeg();
    ScriptedTrial played = Play(robot, {.postures = postures, .lag_s = 2.0, .seed = seed});
    change(played.log);
    SmoothTrajectories({}, played.markers);
    const Eigen::MatrixXd speeds = MarkerSpeeds(played.markers);
    std::vector<int> markers(10);
    std::iota(markers.begin(), markers.end(), 0);
    const LoggedSpeeds logged =
        PredictSpeeds(robot, markers, {0}, SmoothLog(played.log, {}), {0, 1, 2, 3, 4, 5}, 100.0);
    const ClockFit clock = EstimateTrialClock(speeds, 100.0, logged, std::nullopt, {});
    EXPECT_NE(clock.state, ClockState::kReliable);
    const auto means = TakeMeanSpeeds(speeds, 100.0, logged, std::nullopt, {});
    return means ? FindClockMistake(*means, clock.peak) : std::nullopt;
  }
};
using ClockMistakesStudy = ClockMistakes;

TEST_F(ClockMistakes, RowsThatAreMissingAreNamedWithTheirShare) {
  double rate = 0.0;
  const auto found = Find([&](JointLog& log) {
    std::mt19937 random(3);
    std::vector<int> kept;
    for (int i = 0; i < log.time_s.size(); ++i) {
      if (random() % 1000 >= 50) kept.push_back(i);
    }
    const auto count = static_cast<Eigen::Index>(kept.size());
    rate = static_cast<double>(log.time_s.size()) / static_cast<double>(count);
    log.time_s = log.time_s.head(count).eval();
    log.positions = log.positions(kept, Eigen::all).eval();
    log.torques = log.torques(kept, Eigen::all).eval();
  });
  ASSERT_TRUE(found);
  EXPECT_EQ(found->jump_s, 0.0);
  EXPECT_NEAR(found->rate, rate, 0.1 * (rate - 1.0)) << "rows are lost by chance, not evenly";
  EXPECT_NE(Describe(*found).find("% slow, the log fits"), std::string::npos) << Describe(*found);
}

TEST_F(ClockMistakes, AnotherRateIsNamed) {
  const auto fast = Find([](JointLog& log) { log.time_s *= 1.12; });
  ASSERT_TRUE(fast);
  EXPECT_NEAR(fast->rate, 1.0 / 1.12, 0.002);
  EXPECT_NE(Describe(*fast).find("% fast, the log fits"), std::string::npos) << Describe(*fast);
  const auto half = Find([](JointLog& log) { log.time_s *= 2.0; });
  ASSERT_TRUE(half);
  EXPECT_EQ(half->rate, 0.5);
}

TEST_F(ClockMistakes, AJumpIsNamedWithItsSizeAndPlace) {
  for (const double jump : {0.6, -1.5}) {
    const auto found = Find([&](JointLog& log) {
      const Eigen::Index cut = (log.time_s.array() < 25.0).count();
      for (Eigen::Index i = cut; i < log.time_s.size(); ++i) log.time_s[i] += jump;
      if (jump > 0.0) return;
      // The rows of these seconds are missing, and nothing in the log shows it.
      const auto lost =
          (log.time_s.tail(log.time_s.size() - cut).array() <= log.time_s[cut - 1]).count();
      const Eigen::Index tail = log.time_s.size() - cut - lost;
      log.time_s =
          (Eigen::VectorXd(cut + tail) << log.time_s.head(cut), log.time_s.tail(tail)).finished();
      log.positions = (Eigen::MatrixXd(cut + tail, 6) << log.positions.topRows(cut),
                       log.positions.bottomRows(tail))
                          .finished();
      log.torques =
          (Eigen::MatrixXd(cut + tail, 6) << log.torques.topRows(cut), log.torques.bottomRows(tail))
              .finished();
    });
    ASSERT_TRUE(found) << jump;
    EXPECT_EQ(found->rate, 1.0);
    EXPECT_NEAR(found->jump_s, jump, 0.02);
    EXPECT_NEAR(found->at_s, 25.0, 4.0);
  }
}

// In short motions some parts fit somewhere by chance.
TEST_F(ClockMistakesStudy, TheLogOfAnotherMotionHasNone) {
  for (const int postures : {5, 8}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const auto found = Find(
          [&](JointLog& log) {
            log.positions =
                Play(MarkedTalosLeg(), {.postures = postures, .seed = seed + 100}).log.positions;
          },
          postures, seed);
      EXPECT_FALSE(found) << Describe(*found);
    }
  }
}

}  // namespace
}  // namespace elastocal
