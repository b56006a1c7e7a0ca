#include "elastocal/io/posture_checks.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/io/urdf_reader.hpp"
#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

/// Reach 0.5 m, so RobotSize is 1 m.
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
  recording.markers.resize(2, 6);
  recording.markers << 0, 0, 0, 1, 1, 1, 0, 0, 0, 2, 2, 2;
  return recording;
}

TEST(PostureChecks, RangesUpToThreeTimesTheRobotPass) {
  ASSERT_DOUBLE_EQ(RobotSize(Arm()), 1.0);
  Recording recording = TwoPostures();
  recording.markers(1, 2) = -2.9;
  EXPECT_NO_THROW(CheckPlausible(recording, Arm()));
  recording.markers(1, 2) = -3.1;
  ExpectInputError([&] { CheckPlausible(recording, Arm()); },
                   {"t.csv: marker 'A' ranges over 3.1 m along z", "millimetres"});
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

}  // namespace
}  // namespace elastocal
