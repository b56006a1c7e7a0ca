// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/recording.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

/// Three postures of two coordinates and two markers; marker 1 is half lost in posture 1.
Recording MakeRecording() {
  Recording recording;
  recording.source = "file.csv";
  recording.marker_names = {"A", "B"};
  recording.joints_not_recorded = {"head"};
  recording.q.resize(3, 2);
  recording.q << 1, 2, 3, 4, 5, 6;
  recording.markers.resize(3, 6);
  recording.markers << 11, 12, 13, 14, 15, 16, 21, 22, 23, 24, 25, 26, 31, 32, 33, 34, 35, 36;
  recording.markers(1, 4) = std::numeric_limits<double>::quiet_NaN();
  recording.time_s = Eigen::Vector3d(0.1, 0.2, 0.3);
  recording.line = {2, 3, 5};
  return recording;
}

TEST(Recording, CountsAndPositions) {
  const Recording recording = MakeRecording();
  EXPECT_EQ(recording.posture_count(), 3);
  EXPECT_EQ(recording.marker_count(), 2);
  EXPECT_EQ(MarkerPosition(recording, 2, 1), Eigen::Vector3d(34, 35, 36));
}

TEST(Recording, AMarkerIsSeenWhenAllItsCoordinatesAreNumbers) {
  const Recording recording = MakeRecording();
  EXPECT_TRUE(Seen(recording, 0, 1));
  EXPECT_TRUE(Seen(recording, 1, 0));
  EXPECT_FALSE(Seen(recording, 1, 1));
}

TEST(Recording, SelectsPosturesInTheGivenOrder) {
  const Recording selected = SelectPostures(MakeRecording(), {2, 0});
  EXPECT_EQ(selected.source, "file.csv");
  EXPECT_EQ(selected.marker_names, (std::vector<std::string>{"A", "B"}));
  EXPECT_EQ(selected.joints_not_recorded, std::vector<std::string>{"head"});
  EXPECT_EQ(selected.posture_count(), 2);
  EXPECT_EQ(selected.q, (Eigen::Matrix2d() << 5, 6, 1, 2).finished());
  EXPECT_EQ(MarkerPosition(selected, 0, 0), Eigen::Vector3d(31, 32, 33));
  EXPECT_EQ(MarkerPosition(selected, 1, 1), Eigen::Vector3d(14, 15, 16));
  EXPECT_EQ(selected.time_s, Eigen::Vector2d(0.3, 0.1));
  EXPECT_EQ(selected.line, (std::vector<int>{5, 2}));
}

TEST(Recording, JoinsTrialsOfTwoRecordings) {
  Recording first = MakeRecording();
  first.trials.resize(2);
  first.trial = {0, 1, 1};
  Recording second = SelectPostures(MakeRecording(), {2});
  second.trials.resize(1);
  second.trials[0].name = "c";
  second.trial = {0};
  second.torques = Eigen::MatrixXd::Constant(1, 2, 7.0);
  second.frames = {5};
  const Recording joined = JoinTrials(first, second);
  EXPECT_EQ(joined.posture_count(), 4);
  EXPECT_EQ(joined.trial, (std::vector<int>{0, 1, 1, 2}));
  ASSERT_EQ(joined.trials.size(), 3u);
  EXPECT_EQ(joined.trials[2].name, "c");
  EXPECT_EQ(MarkerPosition(joined, 3, 1), Eigen::Vector3d(34, 35, 36));
  EXPECT_TRUE(joined.torques.topRows(3).array().isNaN().all());
  EXPECT_EQ(joined.torques(3, 1), 7.0);
  EXPECT_EQ(joined.frames, (std::vector<int>{1, 1, 1, 5}));
}

TEST(Recording, SelectsWithoutTimesAndLines) {
  Recording recording = MakeRecording();
  recording.time_s.resize(0);
  recording.line.clear();
  const Recording selected = SelectPostures(recording, {1});
  EXPECT_EQ(selected.posture_count(), 1);
  EXPECT_EQ(selected.time_s.size(), 0);
  EXPECT_TRUE(selected.line.empty());
  EXPECT_FALSE(Seen(selected, 0, 1));
  EXPECT_EQ(SelectPostures(recording, {}).posture_count(), 0);
}

}  // namespace
}  // namespace elastocal
