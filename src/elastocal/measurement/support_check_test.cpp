// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/support_check.hpp"

#include <gtest/gtest.h>

#include "tests/standing_biped.hpp"

namespace elastocal {
namespace {

class SupportCheck : public testing::Test {
 protected:
  SupportCheck() {
    // The left foot swings through 0.8 m.
    swinging_.positions.setZero(400, 3 * robot_.model.marker_count());
    for (int m = 0; m < robot_.model.marker_count(); ++m) {
      if (!robot_.model.markers[m].name.starts_with("LFOOT")) continue;
      swinging_.positions.col(3 * m).setLinSpaced(0.0, 0.8);
    }
  }
  std::optional<MovedSupport> Find(const Trial& trial) const {
    return FindMovedSupport(robot_.biped.tree, robot_.model.markers, trial, swinging_);
  }

  const StandingBiped robot_ = {};
  MarkerTrajectories swinging_;
};

TEST_F(SupportCheck, TheWrongFootIsNamedWithTheRightOne) {
  const auto found = Find({.name = "swing", .chains = {}, .support = {robot_.left}});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->link, robot_.left);
  EXPECT_NEAR(found->distance, 0.4, 1e-9);  // from the median, in the middle
  EXPECT_EQ(
      Describe(*found, robot_.biped.tree).find("the support left_sole moves by 400 mm, while "),
      0u);
  ASSERT_GE(found->still, 0);
  EXPECT_EQ(robot_.biped.tree.links[found->still].body, robot_.biped.tree.links[robot_.right].body);
}

TEST_F(SupportCheck, BothFeetDeclaredAndOneSwings) {
  const auto found = Find({.name = "swing", .chains = {}, .support = {robot_.right, robot_.left}});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->link, robot_.left);
}

TEST_F(SupportCheck, WhatStandsIsNotAccused) {
  EXPECT_FALSE(Find({.name = "right", .chains = {}, .support = {robot_.right}}));
  EXPECT_FALSE(Find({.name = "held", .chains = {}}));
  EXPECT_FALSE(Find({.name = "free", .chains = {}, .support = {}, .free_root = true}));
}

}  // namespace
}  // namespace elastocal
