// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/moments.hpp"

#include <gtest/gtest.h>

namespace elastocal {
namespace {

Recording AtTimes(const Eigen::VectorXd& time_s) {
  Recording recording;
  recording.time_s = time_s;
  recording.q.setZero(time_s.size(), 1);
  return recording;
}

TEST(MotionOfPostures, HoldsWhatFollowsWithinHalfASecond) {
  Eigen::VectorXd times(8);
  times << 0.0, 3.0, 3.1, 3.2, 9.0, 9.4, 9.4, 20.0;  // equal times are no motion
  EXPECT_EQ(MotionOfPostures(AtTimes(times)), (std::vector<int>{-1, 0, 0, 0, 1, 1, -1, -1}));
  Recording without = AtTimes(times);
  without.time_s.resize(0);
  EXPECT_EQ(MotionOfPostures(without), std::vector<int>(8, -1));
}

// Two rests of a trial may follow closely, but the robot stopped between the motions.
TEST(MotionOfPostures, InTrialsIsThatOfMotionsOnly) {
  Recording recording = AtTimes(Eigen::VectorXd::LinSpaced(6, 0.0, 0.5));
  recording.trials = {{.name = "rests", .chains = {}},
                      {.name = "sine", .kind = TrialKind::kSine, .chains = {}},
                      {.name = "motion", .chains = {}, .moments = true}};
  recording.trial = {0, 0, 1, 1, 2, 2};
  EXPECT_EQ(MotionOfPostures(recording), (std::vector<int>{-1, -1, 0, 0, 1, 1}));
}

}  // namespace
}  // namespace elastocal
