// SPDX-License-Identifier: Apache-2.0
#include "elastocal/recorded/repeated_trials.hpp"

#include <fstream>
#include <limits>

#include <gtest/gtest.h>

#include "tests/scratch_folder.hpp"

namespace elastocal {
namespace {

/// Two trials of two postures each, with all numbers different.
Recording TwoTrials(const std::string& a, const std::string& b, double from) {
  Recording recording;
  recording.trials = {{.name = a, .chains = {"arm"}}, {.name = b, .chains = {"arm"}}};
  recording.trial = {0, 0, 1, 1};
  recording.marker_names = {"A", "B"};
  recording.q = Eigen::VectorXd::LinSpaced(8, from, from + 1.0).reshaped(4, 2);
  recording.markers = Eigen::VectorXd::LinSpaced(24, from, from + 1.0).reshaped(4, 6);
  return recording;
}

TEST(RepeatedTrials, AreFoundWithinTheEstimateAndAcrossWhateverTheirNames) {
  Measurements measured;
  measured.calibration = TwoTrials("a", "b", 0.0);
  measured.validation = TwoTrials("c", "d", 7.0);
  RepeatedTrials repeated = FindRepeatedTrials(measured);
  EXPECT_TRUE(repeated.estimated_twice.empty());
  EXPECT_TRUE(repeated.judged_by_estimated.empty());

  // A marker that only one of the two trials shows makes no difference.
  Recording& judged = measured.validation;
  judged.q.bottomRows(2) = measured.calibration.q.topRows(2);
  judged.markers.bottomRows(2) = measured.calibration.markers.topRows(2);
  judged.markers(3, 5) = std::numeric_limits<double>::quiet_NaN();
  repeated = FindRepeatedTrials(measured);
  ASSERT_EQ(repeated.judged_by_estimated.size(), 1u);
  EXPECT_EQ(repeated.judged_by_estimated[0].find("trial d is the same recording as trial a"), 0u);
  judged.markers(2, 0) += 1e-9;
  EXPECT_TRUE(FindRepeatedTrials(measured).judged_by_estimated.empty());

  measured.calibration.q.bottomRows(2) = Eigen::MatrixXd(measured.calibration.q.topRows(2));
  measured.calibration.markers.bottomRows(2) =
      Eigen::MatrixXd(measured.calibration.markers.topRows(2));
  EXPECT_EQ(FindRepeatedTrials(measured).estimated_twice.size(), 1u);
}

// Moments of a motion instead of rests: no number is the same, but the files are.
TEST(RepeatedTrials, AreFoundByTheirFilesWhereTheyAreSampledOtherwise) {
  const ScratchFolder folder;
  const auto write = [&](const std::string& name, const std::string& text) {
    std::ofstream(folder.path() / name) << text;
    return (folder.path() / name).string();
  };
  Measurements measured;
  measured.calibration = TwoTrials("a", "b", 0.0);
  measured.validation = TwoTrials("c", "d", 7.0);
  for (const std::string name : {"a", "b", "c", "d"}) {
    TrialSummary summary;
    summary.trial.name = name;
    summary.markers_source = write(name + ".tsv", "markers " + name);
    summary.joints_source = write(name + ".csv", "log " + name);
    summary.rate_hz = 100.0;
    summary.frame_count = 1000;
    measured.trials.push_back(summary);
  }
  EXPECT_TRUE(FindRepeatedTrials(measured).judged_by_estimated.empty());
  write("d.tsv", "markers a");
  const RepeatedTrials repeated = FindRepeatedTrials(measured);
  ASSERT_EQ(repeated.judged_by_estimated.size(), 1u);
  EXPECT_EQ(repeated.judged_by_estimated[0].find("trial d is the same recording as trial a"), 0u);
  EXPECT_TRUE(repeated.estimated_twice.empty());
  write("d.tsv", "markers d");
  write("d.csv", "log a");
  EXPECT_EQ(FindRepeatedTrials(measured).judged_by_estimated.size(), 1u);
  measured.trials[3].log_begin_s = -20.0;  // another take, later in one log
  EXPECT_TRUE(FindRepeatedTrials(measured).judged_by_estimated.empty());
}

TEST(RepeatedTrials, AreNotLookedForInATable) {
  Measurements measured;
  measured.calibration = TwoTrials("a", "b", 0.0);
  measured.calibration.trials.clear();
  measured.calibration.trial.clear();
  EXPECT_TRUE(FindRepeatedTrials(measured).estimated_twice.empty());
}

}  // namespace
}  // namespace elastocal
