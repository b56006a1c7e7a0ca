// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/log_mistake.hpp"

#include <cstdio>

#include <gtest/gtest.h>

#include "tests/standing_leg_trial.hpp"

namespace elastocal {
namespace {

// The speeds of a leg one of whose joints has the wrong sign are others; where they do not fit any
// more, the log that would fit tells why.
TEST(LogMistakesStudy, NamesTheSignAndTheExchangeThatSpoilTheClock) {
  const ScriptedTrial clean = PlayStanding();
  const auto joints = clean.log.positions.cols();
  int refused = 0;
  int named = 0;
  for (Eigen::Index c = 0; c < joints; ++c) {
    ScriptedTrial played = clean;
    played.log.positions.col(c) *= -1.0;
    const std::string reason = Sample(played).summary.refused;
    if (reason.empty()) continue;
    ++refused;
    named += reason.find("with the sign of " + clean.log.names[c] + " reversed the log fits") !=
                     std::string::npos
                 ? 1
                 : 0;
  }
  ScriptedTrial played = clean;
  played.log.positions.col(2).swap(played.log.positions.col(3));
  const std::string reason = Sample(played).summary.refused;
  if (!reason.empty()) {
    ++refused;
    named += reason.find(clean.log.names[2] + " and " + clean.log.names[3] + " exchanged") !=
                     std::string::npos
                 ? 1
                 : 0;
  }
  std::printf("%d of %d faults that spoil the clock are named\n", named, refused);
  EXPECT_GT(refused, 0);
  EXPECT_EQ(named, refused);
}

// A log that comes back with a jump looks like fast motion, which the cameras do not see.
TEST(LogMistakesStudy, NamesTheJointWhoseFrozenLogSpoilsTheClock) {
  int refused = 0, named = 0;
  for (const std::uint64_t seed : {1, 2}) {
    const ScriptedTrial clean =
        PlayStanding({.postures = 30, .range = 0.3, .move_s = 1.5, .seed = seed});
    const Eigen::Index rows = clean.log.positions.rows();
    for (auto c = static_cast<Eigen::Index>(seed); c < clean.log.positions.cols(); c += 3) {
      ScriptedTrial played = clean;
      auto frozen = played.log.positions.col(c).segment(rows / 4, rows / 3);
      frozen.setConstant(frozen[0] + 1.0);
      const std::string reason = Sample(played).summary.refused;
      if (reason.empty()) continue;
      ++refused;
      const std::string part = "the positions of " + clean.log.names[c] + " are frozen from ";
      named += reason.find(part) != std::string::npos ? 1 : 0;
    }
  }
  std::printf("%d of %d frozen joints that spoil the clock are named\n", named, refused);
  EXPECT_GT(refused, 0);
  EXPECT_GE(named, 0.9 * refused);
}

}  // namespace
}  // namespace elastocal
