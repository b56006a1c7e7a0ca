// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/exchanged_sessions.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "elastocal/pipeline/leave_out_touches.hpp"
#include "tests/touching_biped.hpp"

namespace elastocal {
namespace {

/// 90 touches in three sessions. Their tables are 25 mm apart, and the plates alternate.
class ExchangedSessions : public testing::Test {
 protected:
  static constexpr double kNoise = 0.5e-3;  // noise of heights, m

  ExchangedSessions() : sound_(Touches(25e-3)) {}

  Observations Touches(double apart) const {
    Random random(31);
    ObservedValues truth = RandomTruth(model_, 3, random);
    for (std::size_t e = 0; e < truth.effects.size(); ++e) {
      const std::size_t session = e / 2;  // each session has two plates
      truth.effects[e] << apart * static_cast<double>(session), 0.0, 0.0;
    }
    Observations touches = SimulateTouches(model_, truth, 90, 3, {kNoise, 1e-3, 1e-3}, random);
    for (std::size_t e = 0; e < touches.effects.size(); ++e) {
      touches.effects[e].name = std::string("day ") + "abc"[e / 2];
    }
    return touches;
  }

  ObservedRobot model_ = MakeTouchingBiped();
  Observations sound_;
};

TEST_F(ExchangedSessions, AreFoundEach) {
  ContactRun run;
  run.model = model_;
  run.observations = sound_;
  const std::set<int> wrong = {3, 10, 27, 44, 61};
  for (const int i : wrong) {
    int& effect = run.observations.all[static_cast<std::size_t>(i)].effects.front();
    effect = (effect + 2) % 6;  // the next session of the same plate
  }
  const std::vector<OtherSession> found = FindExchangedSessions(model_, run.observations);
  std::set<int> postures;
  for (const OtherSession& of : found) postures.insert(of.posture);
  EXPECT_EQ(postures, wrong);
  EXPECT_TRUE(ExchangeSessions(run));
  for (std::size_t i = 0; i < sound_.all.size(); ++i) {
    EXPECT_EQ(run.observations.all[i].effects, sound_.all[i].effects);
  }
  EXPECT_EQ(run.wrong_rows.find("5 of 90 rows seem to be of another session"), 0u)
      << run.wrong_rows;
  EXPECT_NE(run.wrong_rows.find("of 'day b' as if of 'day a'"), std::string::npos)
      << run.wrong_rows;
}

// The labels of two days are useless: they do not tell which half is right.
TEST_F(ExchangedSessions, AreFoundWhereHalfOfTwoDaysIs) {
  Observations mixed = sound_;
  std::set<int> of_other;
  for (std::size_t i = 0; i < mixed.all.size(); ++i) {
    int& effect = mixed.all[i].effects.front();
    if (effect >= 4 || i / 6 % 2 == 0) continue;  // not day c, and every second round only
    effect = (effect + 2) % 4;
    of_other.insert(mixed.all[i].posture);
  }
  ASSERT_EQ(of_other.size(), 28u);  // out of 60
  const Observations right = InOtherSessions(FindExchangedSessions(model_, mixed), mixed);
  // For each plate, either all labels are as before, or all are those of the other day.
  std::map<int, std::set<bool>> same;
  for (std::size_t i = 0; i < right.all.size(); ++i) {
    if (sound_.all[i].effects.front() >= 4) continue;
    same[right.all[i].instrument].insert(right.all[i].effects == sound_.all[i].effects);
  }
  ASSERT_EQ(same.size(), 2u);
  for (const auto& [plate, ways] : same) EXPECT_EQ(ways.size(), 1u) << plate;
}

// A single row is judged by its error in units of the noise. At three, a row of a clean table may
// err as much by chance. From fifteen on, Student's t with four degrees of freedom excludes it. In
// between it has less weight.
TEST_F(ExchangedSessions, ASingleRowIsLeftOutWhereNoiseDoesNotHideIt) {
  constexpr int kRow = 10;
  for (const double noises : {3.0, 6.0, 10.0, 15.0, 20.0}) {
    Observations one = Touches(noises * kNoise);
    int& effect = one.all[kRow].effects.front();
    effect = (effect + 2) % 6;
    const auto outliers = EstimateObserved(model_, one, {}).outliers;
    const bool named = std::any_of(outliers.begin(), outliers.end(),
                                   [](const auto& of) { return of.observation == kRow; });
    std::printf("  off by %.0f times the noise: %s\n", noises, named ? "named" : "not named");
    if (noises <= 3.0) {
      EXPECT_FALSE(named) << noises;
    } else if (noises >= 20.0) {
      EXPECT_TRUE(named) << noises;
    }
  }
}

// Noise and touches in the air must not be taken for rows of another session.
TEST_F(ExchangedSessions, AreNoneInSoundTables) {
  EXPECT_TRUE(FindExchangedSessions(model_, sound_).empty());
  const auto others = [&](Observations air) {
    for (std::size_t e = 0; e < air.effects.size(); ++e) air.effects[e].name = "abc"[e / 2];
    return FindExchangedSessions(model_, air).size();
  };
  {
    Random random(3);
    const ObservedValues truth = RandomTruth(model_, 3, random);
    std::vector<double> above(48, 0.0);
    for (const std::size_t i : {4u, 9u, 20u, 31u}) above[i] = random.Uniform(5e-3, 40e-3);
    EXPECT_EQ(others(SimulateTouches(model_, truth, 48, 3, {2e-3, 1e-3, 1e-3}, random, above)), 0u);
  }
  Random random(3);
  const ObservedValues truth = RandomTruth(model_, 2, random);
  const auto found = [&](const std::vector<double>& above) {
    return others(SimulateTouches(model_, truth, 48, 2, {1e-3, 1e-3, 1e-3}, random, above));
  };
  std::vector<double> above(48, 0.0);
  for (const std::size_t i : {4u, 9u, 20u, 31u}) above[i] = random.Uniform(5e-3, 40e-3);
  EXPECT_EQ(found(above), 0u);
  // A quarter of the touches are equally high, first in both sessions, then only in the first one.
  std::fill(above.begin(), above.end(), 0.0);
  for (std::size_t i = 0; i < 48; i += 4) above[i + i / 4 % 4] = 25e-3;
  EXPECT_EQ(found(above), 0u);
  std::fill(above.begin(), above.end(), 0.0);
  for (std::size_t i = 0; i < 48; i += 8) above[i] = above[i + 1] = 25e-3;
  EXPECT_EQ(found(above), 0u);
}

}  // namespace
}  // namespace elastocal
