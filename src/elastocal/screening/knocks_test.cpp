// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/knocks.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

// Finding knocks is tested on the whole robot, in tests/knock_test.cpp.

/// Three markers in six postures. Marker m is at (m, posture, 0), and the last one is seen only at
/// the end.
class SplitTest : public ::testing::Test {
 protected:
  SplitTest() {
    RobotTree tree = MakeRoot();
    const int link = AddJoint(tree, "joint", 0, Offset(0.0, 0.0, 1.0), {0.0, 0.0, 1.0});
    model_ = MakeErrorModel(
        tree,
        {{"A", link, {0.1, 0.0, 0.0}}, {"B", link, {0.0, 0.1, 0.0}}, {"C", link, {0.0, 0.0, 0.1}}});
    recording_.marker_names = {"A", "B", "C"};
    recording_.q.setZero(6, 1);
    recording_.markers.setZero(6, 9);
    for (int i = 0; i < 6; ++i) {
      for (int m = 0; m < 3; ++m) recording_.markers.block<1, 3>(i, 3 * m) << m, i, 0.0;
    }
    recording_.markers.block(0, 6, 5, 3).setConstant(std::numeric_limits<double>::quiet_NaN());
  }

  ErrorModel model_;
  Recording recording_;
};

Knock At(int posture, const std::vector<int>& markers) {
  Knock knock;
  knock.posture = posture;
  knock.last_before = posture - 1;
  knock.markers = markers;
  return knock;
}

TEST_F(SplitTest, TheNameStaysWithTheDataAfterTheKnock) {
  SplitMarkers({At(2, {0, 1})}, model_, recording_);
  EXPECT_EQ(recording_.marker_names,
            (std::vector<std::string>{"A", "B", "C", "A(before)", "B(before)"}));
  ASSERT_EQ(model_.marker_count(), 5);
  EXPECT_EQ(model_.markers[4].name, "B(before)");
  EXPECT_EQ(model_.markers[4].link, model_.markers[1].link);
  EXPECT_EQ(model_.markers[4].p_link_marker, model_.markers[1].p_link_marker);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(Seen(recording_, i, 1), i >= 2) << i;
    EXPECT_EQ(Seen(recording_, i, 4), i < 2) << i;
    EXPECT_EQ(MarkerPosition(recording_, i, i < 2 ? 4 : 1), Eigen::Vector3d(1.0, i, 0.0));
  }
}

// Five postures were searched. Order in time tells to which side the left-out posture belongs.
TEST_F(SplitTest, LeftOutPosturesHaveTheMarkerThatTheOrderSays) {
  const std::vector<int> searched = {0, 1, 2, 4, 5}, left_out = {3};
  for (const auto& [at, seen] : {std::pair(4, 3), {3, -1}, {2, 0}}) {  // of those searched
    ErrorModel model = model_;
    Recording training = SelectPostures(recording_, searched);
    Recording rest = SelectPostures(recording_, left_out);
    const std::vector<Knock> knocks = {At(at, {0})};
    SplitMarkers(knocks, model, training);
    SplitLeftOut(knocks, model, searched, left_out, rest);
    EXPECT_EQ(rest.marker_names, training.marker_names);
    EXPECT_EQ(Seen(rest, 0, 3), seen == 3) << at;
    EXPECT_EQ(Seen(rest, 0, 0), seen == 0) << at;  // between the two sides: neither
    EXPECT_TRUE(Seen(rest, 0, 1));
    if (seen < 0) continue;
    EXPECT_EQ(MarkerPosition(rest, 0, seen), Eigen::Vector3d(0.0, 3.0, 0.0));
  }
}

TEST_F(SplitTest, MarkersAreTracedBackThroughTwoKnocks) {
  EXPECT_EQ(MarkersBeforeSplit({At(4, {0, 1}), At(2, {3})}, 3),
            (std::vector<int>{0, 1, 2, 0, 1, 0}));
}

TEST_F(SplitTest, AClusterMayBeKnockedAgain) {
  SplitMarkers({At(4, {0}), At(2, {3}), At(5, {0})}, model_, recording_);
  EXPECT_EQ(
      recording_.marker_names,
      (std::vector<std::string>{"A", "B", "C", "A(before)", "A(before)(before)", "A(before 2)"}));
  const int expected[] = {4, 4, 3, 3, 5, 0};  // the marker that has each posture's data
  for (int i = 0; i < 6; ++i) {
    for (int m : {0, 3, 4, 5}) EXPECT_EQ(Seen(recording_, i, m), m == expected[i]) << i << " " << m;
  }
}

TEST_F(SplitTest, OtherRecordingsLackTheNewMarkers) {
  Recording later = recording_;
  SplitMarkers({At(2, {0})}, model_, recording_);
  AddUnseenMarkers(model_, later);
  EXPECT_EQ(later.marker_names, recording_.marker_names);
  for (int i = 0; i < 6; ++i) {
    EXPECT_TRUE(Seen(later, i, 0));
    EXPECT_FALSE(Seen(later, i, 3));
  }
}

TEST_F(SplitTest, ATableOfPosturesIsNotSearched) {
  EXPECT_TRUE(FindKnocks(model_, recording_, {}, {{"ABC", {0, 1, 2}}}, {}).empty());
}

}  // namespace
}  // namespace elastocal
