// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/posture_checks.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "elastocal/description/urdf_reader.hpp"
#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

/// An arm with a reach of 0.5 m, so that RobotSize is 1 m.
RobotTree Arm() {
  return ParseUrdf(
      "<robot name='r'><link name='a'/><link name='b'/><link name='c'/>"
      "<joint name='turn' type='revolute'><parent link='a'/><child link='b'/>"
      "<limit lower='-1' upper='1' velocity='1' effort='1'/></joint>"
      "<joint name='spin' type='continuous'><parent link='b'/><child link='c'/>"
      "<origin xyz='0.5 0 0'/></joint></robot>",
      "r.urdf");
}

Recording TwoPostures() {
  Recording recording;
  recording.source = "t.csv";
  recording.marker_names = {"A", "B"};
  recording.q = Eigen::MatrixXd::Zero(2, 2);
  recording.q(0, 1) = 0.1;
  recording.markers.resize(2, 6);
  recording.markers << 0, 0, 0, 0, 0, -0.1, 0, 0, 0, 0, 0, -0.2;
  return recording;
}

/// Marker A moves a little and C stands still beside it. B stands still at `b`.
Recording ThreeMarkers(const Eigen::RowVector3d& b) {
  Recording recording = TwoPostures();
  recording.marker_names = {"A", "B", "C"};
  recording.line = {2, 3};
  recording.markers.resize(2, 9);
  recording.markers << 0.1, 0, 0, b, 0, 0.2, 0, 0.2, 0, 0, b, 0, 0.2, 0;
  return recording;
}

TEST(PostureChecks, RangesUpToThreeTimesTheRobotPass) {
  ASSERT_DOUBLE_EQ(RobotSize(Arm()), 1.0);
  Recording recording = TwoPostures();
  recording.markers(1, 2) = -2.9;
  EXPECT_NO_THROW(CheckPlausible(recording, Arm()));
  recording.markers(1, 2) = -3.1;
  ExpectInputError([&] { CheckPlausible(recording, Arm()); },
                   {"t.csv: marker 'A' ranges over 3.1 m along z", "in another unit?"});
}

TEST(PostureChecks, NamesTheUnitsThatFitTheRobot) {
  Recording recording = TwoPostures();
  const auto expect = [&](double range, const std::string& said) {
    recording.markers(1, 2) = range;
    ExpectInputError([&] { CheckPlausible(recording, Arm()); }, {said});
  };
  // The ranges are in other units: no two points of the arm are more than 1 m apart.
  expect(0.4 * 1000, "these look like millimetres; metres were expected");
  expect(0.7 * 100, "these look like centimetres; metres were expected");
  expect(0.4 * 39.37, "these look like inches or centimetres; metres were expected");
  expect(0.15 * 39.37, "these look like inches; metres were expected");
}

TEST(PostureChecks, NamesAMarkerInMillimetresThatStandsStill) {
  EXPECT_NO_THROW(CheckPlausible(ThreeMarkers({2.9, 0, 0}), Arm()));
  Recording recording = ThreeMarkers({0, 0, 3.1});
  ExpectInputError([&] { CheckPlausible(recording, Arm()); },
                   {"t.csv:2: marker 'B' is 3.1", "m from marker 'A'", "in another unit?"});
  // With two markers, the one with the larger coordinates is named.
  recording.markers.rightCols(3).setConstant(std::nan(""));
  ExpectInputError([&] { CheckPlausible(recording, Arm()); }, {"marker 'B' is 3.1", "'A'"});
  // These markers are never seen together.
  recording.markers.leftCols(3).setConstant(std::nan(""));
  recording.markers.row(0) << 0, 0, 0, Eigen::RowVectorXd::Constant(6, std::nan(""));
  EXPECT_NO_THROW(CheckPlausible(recording, Arm()));
}

TEST(PostureChecks, TheOddMarkerIsFarFromMostNotFromTheOrigin) {
  Recording recording = ThreeMarkers({0, 0, 0});
  for (int column : {0, 6}) recording.markers.col(column).array() += 20.0;
  ExpectInputError([&] { CheckPlausible(recording, Arm()); }, {"marker 'B' is 20", "m from"});
}

TEST(PostureChecks, RefusesPosturesThatAreAllTheSame) {
  Recording recording = TwoPostures();
  recording.q.setConstant(0.3);
  ExpectInputError([&] { CheckPlausible(recording, Arm()); },
                   {"t.csv: the 2 postures are all the same"});
  recording.q.conservativeResize(1, 2);
  recording.markers = recording.markers.row(0).eval();
  EXPECT_NO_THROW(CheckPlausible(recording, Arm()));
}

TEST(PostureChecks, WarnsOfRepeatedRows) {
  Recording recording;
  recording.source = "t.csv";
  recording.marker_names = {"A"};
  recording.q = Eigen::MatrixXd::Zero(7, 2);
  recording.markers = Eigen::MatrixXd::Zero(7, 3);
  for (int i = 0; i < 7; ++i) {
    recording.q(i, 1) = i;
    recording.line.push_back(i + 2);
  }
  EXPECT_EQ(RepetitionWarning(recording), "");
  recording.q(3, 1) = 0;
  EXPECT_EQ(RepetitionWarning(recording),
            "t.csv: line 5 repeats line 2: it counts as an independent measurement, which it is "
            "not");
  recording.q.col(1).tail(4).setZero();
  EXPECT_EQ(RepetitionWarning(recording),
            "t.csv: lines 5, 6 and 2 more repeat line 2: they count as independent measurements, "
            "which they are not");
  recording.q.col(1).tail(2).setOnes();
  EXPECT_EQ(RepetitionWarning(recording),
            "t.csv: lines 5, 6 and 2 more repeat lines above them: they count as independent "
            "measurements, which they are not");
  // A posture with another marker position is another measurement. One without markers is no
  // measurement.
  recording.markers(3, 2) = 1e-5;
  recording.markers.bottomRows(3).setConstant(std::nan(""));
  EXPECT_EQ(RepetitionWarning(recording), "");
}

TEST(PostureChecks, AnglesUpToTwoTurnsPass) {
  Recording recording = TwoPostures();
  recording.q(1, 1) = -12.5;
  EXPECT_NO_THROW(CheckPlausible(recording, Arm()));
  recording.q(1, 1) = -12.6;
  ExpectInputError([&] { CheckPlausible(recording, Arm()); }, {"'spin' is at -12.6", "degrees"});
}

TEST(PostureChecks, MarkersMayCoincideInSomePostures) {
  Recording recording = TwoPostures();
  recording.markers.row(0).setConstant(std::nan(""));
  EXPECT_NO_THROW(CheckPlausible(recording, Arm()));
  recording.markers.row(1).setZero();
  ExpectInputError([&] { CheckPlausible(recording, Arm()); }, {"'A' and 'B'", "identical"});
}

TEST(PostureChecks, WarnsBeyondADegree) {
  Recording recording = TwoPostures();
  recording.q(0, 0) = -1.01;
  recording.q(0, 1) = 5.0;  // continuous: no limits
  EXPECT_TRUE(LimitWarnings(recording, Arm()).empty());
  recording.q(1, 0) = -1.02;
  ASSERT_EQ(LimitWarnings(recording, Arm()).size(), 1u);
  EXPECT_EQ(LimitWarnings(recording, Arm())[0],
            "t.csv: joint 'turn' is at -1.02 rad, 1.1459 degrees beyond its limit of -1 rad");
  recording.line = {2, 7};
  EXPECT_EQ(LimitWarnings(recording, Arm())[0].rfind("t.csv:7: ", 0), 0u);
  recording.joints_not_recorded = {"turn"};
  EXPECT_TRUE(LimitWarnings(recording, Arm()).empty());
}

TEST(PostureChecks, ASlidingJointIsInMetres) {
  Joint slide;
  slide.name = "lift";
  slide.type = JointType::kPrismatic;
  slide.limits.lower = 0.0;
  slide.limits.upper = 0.4;
  const auto check = [&](double most) {
    CheckUnits(slide, Eigen::Vector2d(0.1, most),
               [](Eigen::Index i) { return "t.csv:" + std::to_string(i + 2) + ": "; });
  };
  EXPECT_NO_THROW(check(0.5));
  ExpectInputError([&] { check(343.4); },
                   {"t.csv:3: joint 'lift' is at 343.4", "millimetres; metres were expected"});
  slide.limits = JointLimits();  // none
  EXPECT_NO_THROW(check(343.4));
}

// A wheel or a wrist without limits turns many times. Joints with limits tell radians from degrees.
TEST(PostureChecks, JointsWithoutLimitsMayTurnManyTimes) {
  const RobotTree arm = Arm();
  const std::vector<const Joint*> joints = {&arm.joints[0], &arm.joints[1]};
  const auto check = [&](double turn, double spin) {
    CheckUnits(joints, (Eigen::MatrixXd(2, 2) << 0, 0, turn, spin).finished(),
               [](Eigen::Index i) { return "t.csv:" + std::to_string(i + 2) + ": "; });
  };
  EXPECT_NO_THROW(check(0.9, 132.5));
  ExpectInputError([&] { check(40.0, 132.5); }, {"t.csv:3: joint 'turn' is at 40", "degrees"});
  // Within two turns, but beyond its limits of 1 rad: all joints are in degrees.
  ExpectInputError([&] { check(10.0, 132.5); }, {"joint 'spin' is at 132.5", "degrees"});
  // Nothing tells.
  ExpectInputError([&] { check(0.0, 132.5); }, {"joint 'spin' is at 132.5", "degrees"});
}

TEST(PostureChecks, TimesInHoursAreRefused) {
  Recording recording = TwoPostures();
  recording.line = {2, 3};
  recording.q(0, 0) = 0.9;
  recording.time_s = Eigen::Vector2d(0.0, 45.0);
  EXPECT_NO_THROW(CheckPlausible(recording, Arm()));
  recording.time_s /= 3600.0;
  ExpectInputError([&] { CheckPlausible(recording, Arm()); },
                   {"t.csv:3: joint 'turn' would have moved at 72 rad/s", "seconds were expected"});
}

}  // namespace
}  // namespace elastocal
