// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/sole_changes.hpp"

#include <gtest/gtest.h>

namespace elastocal {
namespace {

TEST(CompareSoles, AWornSoleDiffersByMoreThanBothIntervals) {
  const SoleSpring before{.leg = "left", .changes = 2, .compliance = 8e-7, .sd = 3e-8};
  SoleSpring after{.leg = "left", .changes = 2, .compliance = 9.5e-7, .sd = 4e-8};
  const std::vector<SoleSpring> earlier = {before, {.leg = "right"}};
  const std::vector<SoleDifference> found = CompareSoles(earlier, {{.leg = "right"}, after});
  ASSERT_EQ(found.size(), 1u);  // the right sole has no estimate
  EXPECT_EQ(found[0].leg, "left");
  EXPECT_NEAR(found[0].sd, 5e-8, 1e-15);
  EXPECT_NEAR(found[0].half_width, 1.96 * 5e-8, 1e-15);
  EXPECT_TRUE(found[0].significant());
  after.compliance = 8.9e-7;
  EXPECT_FALSE(CompareSoles(earlier, {after}).at(0).significant());
  after.compliance = 7e-7;
  EXPECT_TRUE(CompareSoles(earlier, {after}).at(0).significant());
  after.interval_factor = 12.7;  // with one change of load
  EXPECT_FALSE(CompareSoles(earlier, {after}).at(0).significant());
}

}  // namespace
}  // namespace elastocal
