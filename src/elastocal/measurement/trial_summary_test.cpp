// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/trial_summary.hpp"

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

// If two limbs' markers have each other's labels, neither fits its cluster. A single marker that
// does not fit was displaced, and so were two of one cluster.
TEST(TrialSummary, TwoMarkersThatAreOffMostOfTheTimeMayHaveEachOthersLabels) {
  const auto findings = [](const std::vector<std::pair<int, int>>& off) {
    TrialSummary summary;
    summary.trial.name = "swing";
    summary.rate_hz = 100.0;
    summary.frame_count = 1000;
    summary.log_end_s = 10.0;
    summary.markers = {"HAND_1", "HAND_2", "KNEE_1", "KNEE_2"};
    summary.labels.resize(2);
    summary.labels[0].markers = {0, 1};
    summary.labels[1].markers = {2, 3};
    for (const auto& [marker, frames] : off) {
      summary.labels[marker / 2].outliers.push_back({{0, frames}, marker});
    }
    return Findings(summary);
  };
  ASSERT_EQ(findings({{1, 600}, {2, 900}}).size(), 1u);
  EXPECT_EQ(findings({{1, 600}, {2, 900}})[0],
            "trial swing: HAND_2 and KNEE_1 are off the shapes of their clusters most of the time; "
            "not used there. Were the labels of HAND_2 and KNEE_1 exchanged?");
  EXPECT_EQ(findings({{1, 400}, {2, 900}}).size(), 2u);
  EXPECT_EQ(findings({{0, 600}, {1, 900}}).size(), 2u);
  EXPECT_EQ(findings({{2, 900}}).size(), 1u);
}

}  // namespace
}  // namespace elastocal
