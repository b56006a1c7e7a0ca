// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/exchanged_sessions.hpp"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "elastocal/pipeline/leave_out_touches.hpp"
#include "tests/touching_biped.hpp"

namespace elastocal {
namespace {

/// 90 touches in three sessions whose tables are 25 mm apart; the plates take turns.
class ExchangedSessions : public testing::Test {
 protected:
  ExchangedSessions() {
    Random random(31);
    ObservedValues truth = RandomTruth(model_, 3, random);
    for (std::size_t e = 0; e < truth.effects.size(); ++e) {
      const std::size_t session = e / 2;  // of two plates each
      truth.effects[e] << 25e-3 * static_cast<double>(session), 0.0, 0.0;
    }
    sound_ = SimulateTouches(model_, truth, 90, 3, {0.5e-3, 1e-3, 1e-3}, random);
    for (std::size_t e = 0; e < sound_.effects.size(); ++e) {
      sound_.effects[e].name = std::string("day ") + "abc"[e / 2];
    }
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

// Neither noise nor a touch in the air is a row of another session.
TEST_F(ExchangedSessions, AreNoneInSoundTables) {
  EXPECT_TRUE(FindExchangedSessions(model_, sound_).empty());
  Random random(3);
  ObservedValues truth = RandomTruth(model_, 3, random);
  std::vector<double> above(48, 0.0);
  for (const std::size_t i : {4u, 9u, 20u, 31u}) above[i] = random.Uniform(5e-3, 40e-3);
  Observations air = SimulateTouches(model_, truth, 48, 3, {2e-3, 1e-3, 1e-3}, random, above);
  for (std::size_t e = 0; e < air.effects.size(); ++e) air.effects[e].name = "abc"[e / 2];
  EXPECT_TRUE(FindExchangedSessions(model_, air).empty());
}

}  // namespace
}  // namespace elastocal
