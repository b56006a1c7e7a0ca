// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/model_comparison.hpp"

#include <chrono>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

TEST(FoldsFor, EqualPosturesAreOneUnitHoweverManyOthersLieBetween) {
  // Two joints that move against each other by more than a fold tells apart, there and back.
  constexpr int kThere = 300;
  Recording recording;
  recording.q.resize(2 * kThere, 2);
  for (int i = 0; i < kThere; ++i) {
    for (const int row : {i, i + kThere}) recording.q.row(row) << 0.03 * i, -0.03 * i;
  }
  EXPECT_EQ(FoldsFor(recording, 2 * kThere), kThere);
}

// All pairs of them would take minutes.
TEST(FoldsFor, ManyEqualPosturesAreCountedAtOnce) {
  Recording recording;
  recording.q.setZero(100000, 6);
  recording.q.bottomRows(50000).setOnes();
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(FoldsFor(recording, 10), 2);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
}

}  // namespace
}  // namespace elastocal
