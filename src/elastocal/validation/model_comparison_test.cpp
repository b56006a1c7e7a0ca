// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/model_comparison.hpp"

#include <chrono>
#include <cmath>

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

// A motion at 100 Hz: each moment is nearly equal to the next one. Its stretches of five seconds
// stay apart.
TEST(FoldsFor, MomentsOfAMotionAreNoRepetitions) {
  constexpr int kMoments = 1500;
  Recording recording;
  recording.q.resize(kMoments, 2);
  recording.time_s.resize(kMoments);
  for (int i = 0; i < kMoments; ++i) {
    recording.time_s[i] = 0.01 * i;
    recording.q.row(i) << 0.01 * i, std::sin(0.02 * i);
  }
  EXPECT_EQ(FoldsFor(recording, 10), 3);
  // A minute later it goes the same way: what is held out must not be there once more.
  Recording again = recording;
  again.q.resize(2 * kMoments, 2);
  again.q << recording.q, recording.q;
  again.time_s.resize(2 * kMoments);
  again.time_s << recording.time_s, recording.time_s.array() + 60.0;
  EXPECT_EQ(FoldsFor(again, 10), 3);
  // There and back at once: the last stretch is the first one, backwards.
  Recording back = again;
  back.q.bottomRows(kMoments) = recording.q.colwise().reverse();
  back.time_s.tail(kMoments) = recording.time_s.array() + 0.01 * kMoments;
  EXPECT_EQ(FoldsFor(back, 10), 3);
}

// A head that looks about makes no new postures of an arm.
TEST(FoldsFor, PosturesDifferByTheJointsThatMoveWhatIsMeasured) {
  constexpr int kPostures = 12, kTimes = 8;
  Recording recording;
  recording.q.resize(kPostures * kTimes, 2);
  for (int i = 0; i < kPostures * kTimes; ++i) recording.q.row(i) << 0.1 * (i % kPostures), 0.3 * i;
  EXPECT_EQ(FoldsFor(recording, 50), 50);
  EXPECT_EQ(FoldsFor(recording, 50, {0}), kPostures);
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
