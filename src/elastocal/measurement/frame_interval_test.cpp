// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/frame_interval.hpp"

#include <gtest/gtest.h>

namespace elastocal {
namespace {

TEST(RunsWhere, FindsRunsAtBothEnds) {
  const std::vector<bool> holds{true, true, false, true, false, false, true};
  const auto predicate = [&](int frame) { return holds[static_cast<std::size_t>(frame)]; };
  EXPECT_EQ(RunsWhere(7, predicate), (std::vector<FrameInterval>{{0, 2}, {3, 4}, {6, 7}}));
  EXPECT_EQ(FrameCount(RunsWhere(7, predicate)), 4);
  EXPECT_TRUE(RunsWhere(0, predicate).empty());
}

}  // namespace
}  // namespace elastocal
