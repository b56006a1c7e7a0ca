// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/thinned_motions.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

/// Ten postures at rest, then `moments` moments of a motion.
Recording RestAndMotion(int moments) {
  Recording recording;
  recording.trials = {{"rest", TrialKind::kCalibration, {}}, {"swing", TrialKind::kSine, {}}};
  recording.trial.assign(10, 0);
  recording.trial.resize(10 + static_cast<std::size_t>(moments), 1);
  recording.marker_names = {"A"};
  recording.q = Eigen::MatrixXd::Zero(10 + moments, 1);
  recording.markers = Eigen::MatrixXd::Zero(10 + moments, 3);
  recording.markers.row(20).setConstant(std::numeric_limits<double>::quiet_NaN());
  return recording;
}

TEST(ThinnedMotions, KeepRestAndEvenlySoManyMoments) {
  EXPECT_EQ(WithThinnedMotions(RestAndMotion(1000), 100).posture_count(), 110);
  EXPECT_EQ(WithThinnedMotions(RestAndMotion(50), 100).posture_count(), 60);
}

// A leg that moves little keeps all its moments, while the arms' many moments are thinned.
TEST(ThinnedMotions, KeepEnoughOfEachGroup) {
  const Recording recording = RestAndMotion(3000);
  std::vector<int> group(3010, 0);
  std::fill_n(group.begin() + 1000, 15, 1);
  std::fill_n(group.begin() + 2000, 100, 2);
  std::vector<int> kept(3, 0);
  for (const int i : ThinnedMotions(recording, 300, group, 30)) ++kept[group[i]];
  EXPECT_EQ(kept, (std::vector<int>{10 + 289, 15, 34}));  // 10 + 2885 / 10, all 15, 100 / 3
}

// The sample contains all that a correction changes, however little it is.
TEST(ThinnedMotions, FewPosturesHoldWhatIsCorrected) {
  const Recording recorded = RestAndMotion(1000);
  Recording corrected = recorded;
  corrected.markers.middleRows(501, 3).setConstant(1.0);
  const std::vector<int> few = FewPostures(recorded, corrected, 100);
  EXPECT_EQ(few.size(), 10u + 3u + 100u);
  for (const int row : {0, 9, 501, 502, 503}) EXPECT_EQ(std::count(few.begin(), few.end(), row), 1);
  EXPECT_TRUE(std::is_sorted(few.begin(), few.end()));
  // If half of the moments are changed, both halves are sampled alike.
  corrected.q.bottomRows(500).setConstant(1.0);
  EXPECT_EQ(FewPostures(recorded, corrected, 100).size(), 10u + 84u + 100u);  // out of 503 and 497
}

TEST(ThinnedMotions, FewPosturesAreNotSoughtWhereTheySaveLittle) {
  EXPECT_TRUE(FewPostures(RestAndMotion(300), RestAndMotion(300), 100).empty());
  Recording table = RestAndMotion(1000);
  table.trials.clear();
  table.trial.clear();
  EXPECT_TRUE(FewPostures(table, table, 100).empty());
  EXPECT_TRUE(FewPostures(RestAndMotion(1000), RestAndMotion(999), 100).empty());
}

}  // namespace
}  // namespace elastocal
