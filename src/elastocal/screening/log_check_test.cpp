// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/log_check.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/screening/label_check.hpp"
#include "elastocal/screening/positions_by_markers.hpp"
#include "tests/standing_biped.hpp"

namespace elastocal {
namespace {

constexpr int kPlayed = 12;  // postures per trial

/// A biped with errors of usual size plays random postures in two trials, each at its own place.
class LogCheckTest : public testing::Test {
 protected:
  LogCheckTest()
      : recording_(robot_.Empty({{.name = "a", .chains = {}, .support = {robot_.left}},
                                 {.name = "b", .chains = {}, .support = {robot_.right}}},
                                kPlayed)) {
    Random random(5);
    Eigen::VectorXd& truth = truth_;
    truth.setZero(robot_.model.parameter_count());
    for (int i = 0; i < robot_.model.parameter_count(); ++i) {
      const Parameter& parameter = robot_.model.parameters[i];
      if (parameter.kind == ParameterKind::kWaistPose || IsElastic(parameter.kind)) continue;
      truth[i] = random.Normal(parameter.unit == ParameterUnit::kRadian ? 0.01 : 2e-3);
    }
    geometry_ = ApplyErrors(robot_.model, truth);
    for (int i = 0; i < recording_.posture_count(); ++i) {
      recording_.q.row(i) = 0.8 * RandomPosture(robot_.biped.tree, random).transpose();
      waist_.push_back(Transform(Eigen::Translation3d(1.0, i < kPlayed ? 2.0 : 3.0, 0.9)) *
                       RotZ(0.5 + 0.02 * random.Normal(1.0)) * RotX(0.02 * random.Normal(1.0)));
    }
    See(recording_);
  }

  /// Sets the markers to where the recording's positions put them.
  void See(Recording& recording) { See(robot_.model, geometry_, recording); }

  void See(const ErrorModel& model, Geometry& geometry, Recording& recording) const {
    for (int i = 0; i < recording.posture_count(); ++i) {
      PlaceWaist(waist_[Size(i)], Vector6d::Zero(), geometry);
      recording.markers.row(i) =
          MarkerPositions(model, geometry, recording.q.row(i).transpose()).reshaped().transpose();
    }
  }

  int Coordinate(const std::string& joint) const {
    return robot_.biped.tree.joints[FindJoint(robot_.biped.tree, joint)].coordinate;
  }

  std::vector<LabelCluster> Clusters() const {
    std::vector<LabelCluster> clusters;
    for (const char* name : {"WAIST", "TRUNK", "LFOOT", "RFOOT"}) {
      clusters.push_back({name, {}});
      for (int m = 0; m < robot_.model.marker_count(); ++m) {
        if (robot_.model.markers[m].name.starts_with(name)) clusters.back().markers.push_back(m);
      }
    }
    return clusters;
  }

  /// Describes the first suspicion.
  std::string First(const Recording& recording) const {
    const auto found = FindLogSuspicions(robot_.model, recording);
    return found.empty() ? "" : DescribeSuspicion(found.front(), robot_.biped.tree, recording);
  }

  const StandingBiped robot_ = {};
  Eigen::VectorXd truth_;
  Geometry geometry_;
  std::vector<Transform> waist_;
  Recording recording_;
};

TEST_F(LogCheckTest, TheMarkersShowThePositionsOfTheJoints) {
  Recording changed = recording_;
  changed.q.col(Coordinate("left_4")).array() += 0.3;
  const Eigen::MatrixXd shown = PositionsByMarkers(robot_.model, changed);
  // Errors are half a degree for joints, and millimetres on levers of 0.1 m for markers. One
  // cluster at the end tells six joints, so that the positions are rough near singular postures.
  EXPECT_LT((shown - recording_.q).norm() / std::sqrt(double(shown.size())), 0.06);
  const Eigen::VectorXd knee = (shown - recording_.q).col(Coordinate("left_4"));
  EXPECT_LT(Median(knee.cwiseAbs()), 0.05);  // a cluster 0.4 m away tells it
}

TEST_F(LogCheckTest, NothingIsSaidOfACleanRecording) {
  EXPECT_EQ(First(recording_), "");
  EXPECT_TRUE(FindLabelSuspicions(robot_.model, recording_, Clusters()).empty());
}

TEST_F(LogCheckTest, AReversedSignIsTold) {
  for (const char* joint : {"left_2", "right_5", "left_6"}) {
    Recording changed = recording_;
    changed.q.col(Coordinate(joint)) *= -1.0;
    EXPECT_EQ(First(changed),
              std::string(joint) + ": the sign of its positions is reversed in trial a, b");
    const auto found = FindLogSuspicions(robot_.model, changed);
    ASSERT_FALSE(found.empty());
    EXPECT_TRUE(WithoutMistake(changed, found.front(), robot_.biped.tree).q == recording_.q);
  }
}

// Play and hysteresis depend on the direction from which a joint came.
TEST_F(LogCheckTest, WhatIsUndoneIsUndoneInTheDirectionsOfMotion) {
  NoteApproach(recording_);
  const int a = Coordinate("left_2"), b = Coordinate("right_5");
  Recording reversed = recording_, exchanged = recording_;
  reversed.q.col(a) *= -1.0;
  exchanged.q.col(a).swap(exchanged.q.col(b));
  for (Recording* wrong : {&reversed, &exchanged}) {
    NoteApproach(*wrong);
    ASSERT_FALSE(wrong->approach == recording_.approach);
    const auto found = FindLogSuspicions(robot_.model, *wrong);
    ASSERT_FALSE(found.empty());
    const Recording right = WithoutMistake(*wrong, found.front(), robot_.biped.tree);
    EXPECT_TRUE(right.q == recording_.q);
    EXPECT_TRUE(right.approach == recording_.approach);
  }
}

TEST_F(LogCheckTest, AReversedSignIsToldOfAJointThatIsMountedFarOff) {
  const int ankle = Coordinate("right_5");
  Recording changed = recording_;
  changed.q.col(ankle) *= -0.3;  // a range that is small beside the offset
  See(changed);
  recording_.q.col(ankle) *= 0.3;
  recording_.q.col(ankle).array() += 0.08;
  recording_.markers = changed.markers;
  EXPECT_EQ(First(recording_), "right_5: the sign of its positions is reversed in trial a, b");
}

// In the trial in which it stood still, an offset of the joint would explain as much. The other
// trial tells its sign.
TEST_F(LogCheckTest, AReversedSignIsFollowedToTrialsInWhichTheJointStoodStill) {
  const int hip = Coordinate("left_2");
  recording_.q.col(hip).tail(kPlayed).setConstant(0.3);
  See(recording_);
  Recording changed = recording_;
  changed.q.col(hip) *= -1.0;
  EXPECT_EQ(First(changed), "left_2: the sign of its positions is reversed in trial a, b");
  changed.q.col(hip).head(kPlayed) *= -1.0;
  EXPECT_EQ(First(changed), "");
}

TEST_F(LogCheckTest, AnExchangeOfJointsInOneTrialIsTold) {
  Recording changed = recording_;
  const int hip = Coordinate("left_3");
  const int ankle = Coordinate("left_5");
  changed.q.col(hip).head(kPlayed) = recording_.q.col(ankle).head(kPlayed);
  changed.q.col(ankle).head(kPlayed) = recording_.q.col(hip).head(kPlayed);
  EXPECT_EQ(First(changed), "left_3 and left_5: their positions are exchanged in trial a");
  EXPECT_TRUE(
      WithoutMistake(changed, FindLogSuspicions(robot_.model, changed).front(), robot_.biped.tree)
          .q == recording_.q);
}

// The joints are for instance those of a waist and a neck whose markers only another trial shows.
TEST_F(LogCheckTest, AnExchangeWithAJointThatNoMarkerShowsIsTold) {
  const int trunk = Coordinate("trunk_yaw"), hip = Coordinate("right_3");
  recording_.q.col(hip).head(kPlayed).setZero();
  See(recording_);
  for (int i = 0; i < kPlayed; ++i) robot_.ShowOnly({"WAIST", "TRUNK", "LFOOT"}, i, recording_);
  EXPECT_EQ(First(recording_), "");
  Recording changed = recording_;
  changed.q.col(hip).head(kPlayed) = recording_.q.col(trunk).head(kPlayed);
  changed.q.col(trunk).head(kPlayed).setZero();
  const std::string said = "trunk_yaw and right_3: their positions are exchanged in trial a";
  EXPECT_EQ(First(changed), said);
  // No trial shows it: a model of the markers that are seen does not have this joint.
  changed.marker_names.resize(9);  // without RFOOT
  changed.markers.conservativeResize(Eigen::NoChange, 27);
  ErrorModel without = SelectMarkers(robot_.model, changed.marker_names);
  std::erase(without.active_joints, FindJoint(robot_.biped.tree, "right_3"));
  const auto found = FindLogSuspicions(without, changed);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(DescribeSuspicion(found.front(), robot_.biped.tree, changed), said);
}

TEST_F(LogCheckTest, AFrozenJointIsTold) {
  Recording changed = recording_;
  changed.q.col(Coordinate("right_4"))
      .segment(kPlayed + 5, 6)
      .setConstant(recording_.q(kPlayed + 5, Coordinate("right_4")));
  EXPECT_EQ(First(changed),
            "right_4: its positions are frozen, while it moved, in 6 postures in trial b");
  const auto found = FindLogSuspicions(robot_.model, changed);
  EXPECT_EQ(WithoutMistake(changed, found.front(), robot_.biped.tree).posture_count(),
            2 * kPlayed - 6);
}

// The log resumes while a posture is held, so that the mean of that posture is nearly the frozen
// position.
TEST_F(LogCheckTest, ThePostureInWhichAFrozenJointComesBackIsLeftOutAsWell) {
  Recording changed = recording_;
  auto right_4 = changed.q.col(Coordinate("right_4")).segment(kPlayed + 5, 7);
  ASSERT_GT(std::abs(right_4[6] - right_4[0]), 0.1);
  right_4.setConstant(right_4[0]);
  right_4[6] += 1e-4;
  EXPECT_EQ(First(changed),
            "right_4: its positions are frozen, while it moved, in 7 postures in trial b");
}

TEST_F(LogCheckTest, AJointThatIsLoggedInOnePlaceThroughoutIsTold) {
  Recording changed = recording_;
  changed.q.col(Coordinate("right_4")).setConstant(0.2);
  EXPECT_EQ(First(changed), "right_4: its positions are frozen, while it moved, in " +
                                std::to_string(2 * kPlayed) + " postures in trial a, b");
  See(changed);  // now it really stood still
  EXPECT_EQ(First(changed), "");
}

TEST_F(LogCheckTest, AJointThatIsNotRecordedAndMovesIsSaidToBeNotRecorded) {
  Recording changed = recording_;
  changed.q.col(Coordinate("right_4")).setZero();
  changed.joints_not_recorded = {"right_4"};
  EXPECT_EQ(First(changed),
            "right_4 is not recorded, and the project says that it stood still: it moved in " +
                std::to_string(changed.posture_count()) + " postures in trial a, b");
  for (const LogSuspicion& one : FindLogSuspicions(robot_.model, changed)) {
    EXPECT_EQ(one.kind, LogContradiction::kFrozen) << "there is no column to be exchanged";
  }
}

// The joint rests while others move. The markers show it at one other position, not at several.
TEST_F(LogCheckTest, AJointAtRestIsNotFrozen) {
  Recording rests = recording_;
  auto right_4 = rests.q.col(Coordinate("right_4")).segment(kPlayed + 5, 6);
  right_4.setConstant(right_4[0] + 0.1);
  See(rests);
  right_4.array() -= 0.1;
  EXPECT_EQ(First(rests), "");
}

TEST_F(LogCheckTest, ExchangedLabelsAreTold) {
  Recording changed = recording_;
  const auto clusters = Clusters();
  for (int k = 0; k < 3; ++k) {  // exchanges the feet in the second trial
    changed.markers.block(kPlayed, 3 * clusters[2].markers[k], kPlayed, 3)
        .swap(changed.markers.block(kPlayed, 3 * clusters[3].markers[k], kPlayed, 3));
  }
  auto found = FindLabelSuspicions(robot_.model, changed, clusters);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(DescribeSuspicion(found[0], changed),
            "the labels of LFOOT and RFOOT are exchanged in trial b");
  EXPECT_TRUE(WithoutExchange(changed, found[0]).markers == recording_.markers);

  changed = recording_;
  changed.markers.middleCols<3>(3 * clusters[0].markers[0])
      .swap(changed.markers.middleCols<3>(3 * clusters[0].markers[1]));
  found = FindLabelSuspicions(robot_.model, changed, clusters);
  ASSERT_EQ(found.size(), 1u);  // in one trial alone, it would contradict the other
  EXPECT_EQ(DescribeSuspicion(found[0], changed),
            "the labels of WAIST_1 and WAIST_2 are exchanged in trial a, b");
  EXPECT_TRUE(WithoutExchange(changed, found[0]).markers == recording_.markers);
}

// No position on its own link explains a marker of another one.
TEST_F(LogCheckTest, MarkersOfTwoLinksExchangedInAllTrialsAreTold) {
  const auto clusters = Clusters();
  Recording changed = recording_;
  changed.markers.middleCols<3>(3 * clusters[2].markers[0])
      .swap(changed.markers.middleCols<3>(3 * clusters[3].markers[0]));
  const auto found = FindLabelSuspicions(robot_.model, changed, clusters);
  ASSERT_FALSE(found.empty());
  EXPECT_TRUE(WithoutExchange(changed, found[0]).markers == recording_.markers)
      << DescribeSuspicion(found[0], changed);
}

TEST_F(LogCheckTest, MarkersExchangedInAPartOfATrialAreToldByTheRobotWhereDistancesAreAlike) {
  const auto clusters = Clusters();
  const std::vector<int>& trunk = clusters[1].markers;
  ErrorModel model = robot_.model;
  const Eigen::Vector3d first = model.markers[Size(trunk[0])].p_link_marker;
  const Eigen::Vector3d side = model.markers[Size(trunk[1])].p_link_marker - first;
  model.markers[Size(trunk[2])].p_link_marker = first + 0.5 * side + 0.05 * side.unitOrthogonal();
  Geometry geometry = ApplyErrors(model, truth_);
  Recording clean = recording_;
  See(model, geometry, clean);
  EXPECT_TRUE(FindLabelSuspicions(model, clean, clusters).empty());
  const auto exchanged = [&](int from, int count) {
    Recording changed = clean;
    changed.markers.block(from, 3 * trunk[0], count, 3)
        .swap(changed.markers.block(from, 3 * trunk[1], count, 3));
    return changed;
  };
  // An exchange everywhere does no harm: the project may have named them the other way round.
  EXPECT_TRUE(FindLabelSuspicions(model, exchanged(0, 2 * kPlayed), clusters).empty());

  Recording changed = exchanged(0, kPlayed + 3);
  // A posture that does not show both markers is treated like the postures before it.
  clean.markers.block<1, 3>(5, 3 * trunk[0]).setConstant(kNaN);
  changed.markers.block<1, 3>(5, 3 * trunk[1]).setConstant(kNaN);
  const auto found = FindLabelSuspicions(model, changed, clusters);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(
      DescribeSuspicion(found[0], changed),
      "the labels of TRUNK_1 and TRUNK_2 are exchanged in trial a and in 3 postures of trial b");
  const Eigen::MatrixXd corrected = WithoutExchange(changed, found[0]).markers;
  EXPECT_TRUE((corrected.array() == clean.markers.array() ||
               (corrected.array().isNaN() && clean.markers.array().isNaN()))
                  .all());
  EXPECT_NEAR(found[0].before, side.norm(), 0.05 * side.norm());  // the robot turns the link
  EXPECT_LT(found[0].after, 0.1 * side.norm());
}

}  // namespace
}  // namespace elastocal
