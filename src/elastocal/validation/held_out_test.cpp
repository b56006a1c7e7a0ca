// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/held_out.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/standing_biped.hpp"

namespace elastocal {
namespace {

Transform At(double x, double y, double z) { return FromXyzRpy({x, y, z}, {0.0, 0.0, 0.0}); }

/// Waists are predicted at x = 0, 1, 2, ...; `footing` is that of each posture.
Placement Predicted(const std::vector<int>& footing) {
  Placement placement;
  placement.footings = {{0, 0, {}}};
  placement.footing = footing;
  for (std::size_t i = 0; i < footing.size(); ++i) {
    placement.T_ref_waist.push_back(At(static_cast<double>(i), 0, 0));
  }
  return placement;
}

TEST(WaistError, IsTheRootMeanSquareBesideAConstantShift) {
  // The errors along z are 1, 2 and 6 mm. They differ from their mean, 3 mm, by 2, 1 and 3 mm.
  EXPECT_NEAR(WaistError(Predicted({0, 0, 0}), {At(0, 0, 1e-3), At(1, 0, 2e-3), At(2, 0, 6e-3)}),
              std::sqrt((4.0 + 1.0 + 9.0) / 3.0) * 1e-3, 1e-15);
}

TEST(WaistError, TheShiftIsThatOfPosturesOnTwoFeetWhereThereAreAny) {
  // The error on two feet is 1 mm. The errors on one foot differ from it by 3 and 4 mm.
  EXPECT_NEAR(WaistError(Predicted({-1, 0, 0}), {At(0, 1e-3, 0), At(1, 4e-3, 0), At(2, -3e-3, 0)}),
              std::sqrt((9.0 + 16.0) / 2.0) * 1e-3, 1e-15);
}

TEST(WaistError, NeedsTwoPosturesWhoseTruthIsKnown) {
  EXPECT_TRUE(std::isnan(WaistError(Predicted({0, 0}), {At(0, 0, 0), std::nullopt})));
  EXPECT_TRUE(std::isnan(WaistError(Predicted({-1, -1}), {At(0, 0, 0), At(1, 0, 0)})));
  EXPECT_EQ(WaistError(Predicted({0, 0, 0}), {At(0, 0, 0), std::nullopt, At(2, 0, 0)}), 0.0);
}

TEST(TrialGroups, AreNamedAfterTheChainsThatShareJoints) {
  const StandingBiped robot;
  Recording recording = robot.Empty({{.name = "a", .chains = {"trunk"}},
                                     {.name = "b", .chains = {"left"}, .support = {robot.right}},
                                     {.name = "c", .chains = {"trunk", "head"}}},
                                    1);
  robot.ShowOnly({"TRUNK"}, 0, recording);
  robot.ShowOnly({"LFOOT", "RFOOT"}, 1, recording);
  robot.ShowOnly({"TRUNK"}, 2, recording);
  EXPECT_EQ(TrialGroups(robot.model, recording),
            (std::vector<std::string>{"trunk+head", "left", "trunk+head"}));
}

}  // namespace
}  // namespace elastocal
