// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/noise.hpp"

#include <gtest/gtest.h>

#include "tests/standing_biped.hpp"

namespace elastocal {
namespace {

class NoiseGroupsTest : public testing::Test {
 protected:
  /// Groups of trials of one posture each, with the clusters that they see and the feet that stand.
  std::vector<int> Groups(const std::vector<std::vector<std::string>>& seen,
                          const std::vector<std::vector<int>>& support) const {
    std::vector<Trial> trials;
    for (std::size_t t = 0; t < seen.size(); ++t) {
      trials.push_back({.name = std::to_string(t), .chains = {}, .support = support[t]});
    }
    Recording recording = robot_.Empty(trials, 1);
    for (std::size_t t = 0; t < seen.size(); ++t) {
      robot_.ShowOnly(seen[t], static_cast<int>(t), recording);
    }
    return NoiseGroups(robot_.model, recording);
  }

  const StandingBiped robot_ = {};
};

TEST_F(NoiseGroupsTest, TrialsThatShareJointsAreOne) {
  const int left = robot_.left, right = robot_.right;
  // The markers of the standing foot are seen, but the trial does not exercise the joints of that
  // leg.
  EXPECT_EQ(Groups({{"WAIST", "TRUNK"}, {"WAIST", "LFOOT", "RFOOT"}, {"WAIST", "LFOOT", "RFOOT"}},
                   {{left, right}, {right}, {left}}),
            (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(Groups({{"LFOOT"}, {"TRUNK"}, {"LFOOT", "RFOOT"}}, {{}, {}, {right}}),
            (std::vector<int>{0, 1, 0}));
}

TEST_F(NoiseGroupsTest, ATrialThatSharesWithTwoJoinsThem) {
  EXPECT_EQ(Groups({{"LFOOT"}, {"TRUNK"}, {"RFOOT"}, {"LFOOT", "TRUNK"}}, {{}, {}, {}, {}}),
            (std::vector<int>{0, 0, 1, 0}));
}

// Otherwise standard deviations that nothing has estimated would be reported.
TEST_F(NoiseGroupsTest, ATrialWithoutPosturesHasNone) {
  const Recording both =
      robot_.Empty({{.name = "refused", .chains = {}}, {.name = "used", .chains = {}}}, 1);
  EXPECT_EQ(NoiseGroups(robot_.model, SelectPostures(both, {1})), (std::vector<int>{0}));
}

TEST_F(NoiseGroupsTest, ATableOfPosturesIsOneGroup) {
  Recording recording = robot_.Empty({{.name = "t", .chains = {}}}, 3);
  recording.trials.clear();
  recording.trial.clear();
  EXPECT_EQ(NoiseGroups(robot_.model, recording), (std::vector<int>{0, 0, 0}));
}

}  // namespace
}  // namespace elastocal
