// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/log_mistake.hpp"

#include <cstdio>

#include <gtest/gtest.h>

#include "elastocal/measurement/stable_samples.hpp"
#include "tests/standing_leg_trial.hpp"

namespace elastocal {
namespace {

/// A clock fit of which only the correlation of the speeds is known.
ClockFit Correlated(double peak) {
  ClockFit clock;
  clock.peak = peak;
  return clock;
}

// A joint with the wrong sign changes the predicted speeds of a leg. If they no longer fit, the
// trial is refused, and the reason names the log that would fit.
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
    // If the user asks for it, the sign is corrected for the clock but not in the positions.
    MeasurementOptions on_request;
    on_request.accepted = {"sign:" + clean.log.names[c]};
    const TrialSamples told = Sample(played, on_request);
    EXPECT_EQ(told.summary.refused, "");
    EXPECT_EQ(told.summary.clock_without, on_request.accepted);
    EXPECT_LT((told.q.col(c) + Sample(clean).q.col(c)).cwiseAbs().maxCoeff(), 0.01);
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

// A log that ends its freeze with a jump seems to show a fast motion, which the cameras do not see.
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

// Reversing either of two parallel axes gives markers the same speeds.
TEST(LogMistakesStudy, PositionsTellWhichOfTwoParallelAxesTurnsTheOtherWay) {
  MarkedRobot robot = WaistAndLeg();
  for (const int still : {0, 1, 4, 5}) robot.tree.joints[still].limits = {};
  for (Marker& marker : robot.markers) {
    if (marker.link != 0) marker.p_link_marker.x() = 0.0;
  }
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    const ScriptedTrial clean = Play(robot, {.postures = 12, .move_s = 1.5, .seed = seed});
    MarkerTrajectories markers = clean.markers;
    SmoothTrajectories({}, markers);
    for (const int pitch : {2, 3}) {  // joints of hip and knee
      ScriptedTrial played = clean;
      played.log.positions.col(pitch) *= -1.0;
      const auto found = FindLogMistake(robot, AllMarkers(robot), {0}, SmoothLog(played.log, {}),
                                        {0, 1, 2, 3, 4, 5}, MarkerSpeeds(markers), markers, 0.0, {},
                                        Correlated(0.9));
      ASSERT_TRUE(found);
      EXPECT_EQ(NameOf(*found, clean.log.names), "sign:" + clean.log.names[pitch]) << seed;
    }
  }
}

// On the way back the speeds are those of the way there, and exchanged columns may fit them even
// better. Positions tell the lag, and show that the columns are right.
TEST(LogMistakes, AMotionThereAndBackIsNoMistake) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    const ScriptedTrial played = PlayStanding({.postures = 3,
                                               .range = 0.3,
                                               .move_s = 1.5,
                                               .rest_s = 0.8,
                                               .lag_s = 2.4,
                                               .there_and_back = true,
                                               .seed = seed});
    const TrialSummary told = Sample(played).summary;
    EXPECT_EQ(told.refused, "") << seed;
    EXPECT_NEAR(told.clock.lag_s, 2.4, 0.01) << seed;
  }
}

// Joints that are moved one after the other stand still for long while others move.
TEST(LogMistakesStudy, JointsThatMoveOneAfterTheOtherAreNotFrozen) {
  const MarkedRobot robot = WaistAndLeg();
  const ScriptedTrial clean = PlayStanding({.postures = 12, .move_s = 1.5, .one_by_one = true});
  const auto find = [&](const ScriptedTrial& played, double peak) {
    MarkerTrajectories markers = played.markers;
    SmoothTrajectories({}, markers);
    return FindLogMistake(robot, AllMarkers(robot), {kFoot}, SmoothLog(played.log, {}),
                          {0, 1, 2, 3, 4, 5}, MarkerSpeeds(markers), markers, 0.0, {},
                          Correlated(peak));
  };
  const auto found = find(clean, 0.999);
  EXPECT_FALSE(found) << Describe(*found, clean.log.names);
  // If one joint moves at a time, reversing its sign keeps the speeds but not the positions.
  const auto by_speeds = find(clean, 0.5);
  EXPECT_FALSE(by_speeds) << Describe(*by_speeds, clean.log.names);

  ScriptedTrial frozen = clean;  // a joint is frozen in the middle of its motion
  const Eigen::Index rows = clean.log.positions.rows();
  auto part = frozen.log.positions.col(3).segment(rows / 6, rows / 2);
  part.setConstant(part[0]);
  const auto mistake = find(frozen, 0.9);
  ASSERT_TRUE(mistake);
  EXPECT_EQ(mistake->column, 3);
  EXPECT_GT(mistake->frozen_to_s, mistake->frozen_from_s);
}

// The header lacks a name before the limb, or has one too many.
TEST(LogMistakes, ColumnsOfALimbThatAreAllMovedByOneAreNamed) {
  const MarkedRobot robot = WaistAndLeg();
  const ScriptedTrial clean = PlayStanding({.postures = 12, .move_s = 1.5});
  MarkerTrajectories markers = clean.markers;
  SmoothTrajectories({}, markers);
  for (const int by : {1, -1}) {
    ScriptedTrial moved = clean;
    for (int c = 0; c < 6; ++c) {
      moved.log.positions.col(c) = clean.log.positions.col((c - by + 6) % 6);
    }
    const auto found = FindLogMistake(robot, AllMarkers(robot), {kFoot}, SmoothLog(moved.log, {}),
                                      {0, 1, 2, 3, 4, 5}, MarkerSpeeds(markers), markers, 0.0, {},
                                      Correlated(0.5));
    ASSERT_TRUE(found);
    EXPECT_EQ(found->moved, by);
    EXPECT_EQ(found->column, 0);
    EXPECT_EQ(found->exchanged, 5);
    EXPECT_GT(found->peak, 0.99);
    const SmoothedLog back = WithoutMistake(SmoothLog(moved.log, {}), *found);
    EXPECT_EQ(back.pieces[0].values, SmoothLog(clean.log, {}).pieces[0].values);
    EXPECT_EQ(Describe(*found, clean.log.names)
                  .find("with the columns of " + clean.log.names[0] + " to " + clean.log.names[5]),
              0u);
  }
}

TEST(LogMistakes, CopiesOfColumnsAreNamed) {
  ScriptedTrial played = PlayStanding({.postures = 12, .move_s = 1.5});
  EXPECT_EQ(DescribeCopies(SmoothLog(played.log, {}), played.log.names), "");
  played.log.positions.col(4) = played.log.positions.col(2);
  EXPECT_EQ(DescribeCopies(SmoothLog(played.log, {}), played.log.names),
            "the columns of " + played.log.names[2] + " and " + played.log.names[4] +
                " are copies of each other, number for number");
  for (const int still : {2, 4}) played.log.positions.col(still).setZero();
  EXPECT_EQ(DescribeCopies(SmoothLog(played.log, {}), played.log.names), "")
      << "joints that stand still";
}

}  // namespace
}  // namespace elastocal
