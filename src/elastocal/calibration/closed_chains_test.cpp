// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/closed_chains.hpp"

#include <gtest/gtest.h>

#include "tests/standing_biped.hpp"

namespace elastocal {
namespace {

TEST(ClosedChains, HideTheFeetThatStandTogetherAndNothingElse) {
  const StandingBiped robot;
  Recording recording =
      robot.Empty({{.name = "both", .chains = {}, .support = {robot.left, robot.right}},
                   {.name = "left", .chains = {}, .support = {robot.left}},
                   {.name = "held", .chains = {}}},
                  1);
  HideClosedChains(robot.biped.tree, robot.model.markers, recording);
  for (int m = 0; m < recording.marker_count(); ++m) {
    const bool foot = recording.marker_names[m].find("FOOT") != std::string::npos;
    EXPECT_EQ(Seen(recording, 0, m), !foot) << recording.marker_names[m];
    EXPECT_TRUE(Seen(recording, 1, m));
    EXPECT_TRUE(Seen(recording, 2, m));
  }
}

TEST(ClosedChains, LeaveMarkersThatTheProjectDoesNotKnow) {
  const StandingBiped robot;
  Recording recording =
      robot.Empty({{.name = "both", .chains = {}, .support = {robot.left, robot.right}}}, 1);
  recording.marker_names.back() = "PROP";
  HideClosedChains(robot.biped.tree, robot.model.markers, recording);
  EXPECT_TRUE(Seen(recording, 0, recording.marker_count() - 1));
  EXPECT_FALSE(Seen(recording, 0, recording.marker_count() - 2));
}

}  // namespace
}  // namespace elastocal
