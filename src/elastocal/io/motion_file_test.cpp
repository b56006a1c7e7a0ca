// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/motion_file.hpp"

#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/expect_input_error.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

Project MotionProject() { return ReadProject(SourceFile("tests/robots/arm6_project.yaml")); }

JointMotion ParseMotion(const std::string& text, const Project& project = MotionProject()) {
  std::istringstream stream(text);
  return ReadMotion(stream, "m.csv", project);
}

JointMotion ParsePostures(const std::string& text, const Project& project = MotionProject()) {
  std::istringstream stream(text);
  return ReadPostureList(stream, "p.csv", project);
}

void ExpectMotionError(const std::string& text, std::initializer_list<std::string> parts) {
  ExpectInputError([&] { ParseMotion(text); }, parts);
}

int Coordinate(const Project& project, const std::string& joint) {
  return project.tree.joints[FindJoint(project.tree, joint)].coordinate;
}

TEST(MotionFile, ReadsATrajectory) {
  const Project project = MotionProject();
  const JointMotion motion = ParseMotion(
      "time,elbow_joint,finger_right_joint,turret_joint,zmp_x,zmp_y,torque_elbow_joint\n"
      "1,0.1,w,-0.2,a,b,c\n1.5,0.2,,-0.1,,,\n",
      project);
  EXPECT_EQ(motion.source, "m.csv");
  EXPECT_EQ(motion.time_s, Eigen::Vector2d(1.0, 1.5));
  EXPECT_EQ(motion.q.col(Coordinate(project, "elbow_joint")), Eigen::Vector2d(0.1, 0.2));
  EXPECT_EQ(motion.q.col(Coordinate(project, "turret_joint")), Eigen::Vector2d(-0.2, -0.1));
  EXPECT_TRUE(motion.q.col(Coordinate(project, "rail_joint")).array().isNaN().all());
  EXPECT_TRUE(motion.support.empty());
  EXPECT_EQ(motion.line, (std::vector<int>{2, 3}));
}

TEST(MotionFile, SaysWhereAPostureFileBelongs) {
  ExpectMotionError("robot: \"arm6\"\nchains:\n  - name: \"arm\"\n",
                    {"m.csv:1", "posture file", "--postures", "'plan'"});
}

TEST(MotionFile, ReadsWhatStandsOnTheFloor) {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  const int left = FindLink(project.tree, "left_sole_link");
  const int right = FindLink(project.tree, "right_sole_link");
  const JointMotion motion = ParseMotion(
      "time,torso_1_joint,support\n0,0,both\n1,0.1,left_sole_link\n2,0,right_sole_link\n"
      "3,0,none\n4,0,right_sole_link + left_sole_link\n",
      project);
  EXPECT_EQ(motion.support,
            (std::vector<std::vector<int>>{{left, right}, {left}, {right}, {}, {right, left}}));
  const auto refused = [&](const std::string& support, const std::string& part) {
    ExpectInputError(
        [&] { ParseMotion("time,torso_1_joint,support\n0,0,both\n1,0," + support, project); },
        {"m.csv:3: column 'support'", part});
  };
  refused("left_sole_lnk", "did you mean 'left_sole_link'");
  refused("", "expected 'both', 'none' or the tip of a chain");
  refused("both+left_sole_link", "names a link twice");
  ExpectMotionError("time,elbow_joint,support\n0,0,both\n", {"'both'"});  // an arm has no feet
}

TEST(MotionFile, AListOfPosturesNeedsNeitherTimeNorMarkers) {
  const Project project = MotionProject();
  const JointMotion postures =
      ParsePostures("elbow_joint,turret_joint\n0.1,0.2\n-0.1,0.3\n", project);
  EXPECT_EQ(postures.time_s.size(), 0);
  EXPECT_EQ(postures.q.col(Coordinate(project, "turret_joint")), Eigen::Vector2d(0.2, 0.3));
  // A posture table with markers is accepted too. Jumps between its postures are not taken as
  // speeds.
  const JointMotion table =
      ParsePostures("t,WRIST_x,WRIST_y,WRIST_z,elbow_joint\n1,,,,0.1\n1.001,0,0,0,1.1\n", project);
  EXPECT_EQ(table.sample_count(), 2);
  EXPECT_EQ(table.time_s.size(), 0);
  EXPECT_EQ(ParsePostures("elbow_joint\n0.5\n", project).sample_count(), 1);
}

TEST(MotionFile, RefusesWhatIsNoMotion) {
  ExpectMotionError("", {"m.csv", "is empty"});
  ExpectMotionError("time,elbow_joint\n", {"m.csv", "found 0 rows", "2 or more"});
  ExpectMotionError("time,elbow_joint\n0,0\n", {"found 1 rows"});
  ExpectMotionError("elbow_joint\n0\n1\n", {"m.csv:1: ", "no column 'time'"});
  ExpectMotionError("time,zmp_x\n0,0\n1,0\n", {"m.csv:1: ", "no column of any joint"});
  ExpectMotionError("time,elbow_jiont\n0,0\n1,0\n", {"m.csv:1: ", "did you mean 'elbow_joint'"});
  ExpectMotionError("0,0\n1,0\n", {"m.csv:1: ", "header row"});
  ExpectMotionError("time,t,elbow_joint\n0,0,0\n", {"'time' and 't' stand for the same"});
  ExpectMotionError("time,elbow_joint,elbow_joint\n0,0,0\n", {"'elbow_joint' comes twice"});
  ExpectMotionError("time,elbow_joint\n0,0,0\n1,0\n", {"m.csv:2: ", "3 cells; the header has 2"});
  ExpectMotionError("time,elbow_joint\n0,0\n1,\n", {"m.csv:3: ", "elbow_joint"});
  ExpectMotionError("time,elbow_joint\n0,0\n1,nan\n", {"m.csv:3: ", "elbow_joint"});
  ExpectMotionError("time,elbow_joint\n1,0\n1,0\n", {"m.csv:3: ", "must increase"});
  ExpectMotionError("time,WRIST_x,elbow_joint\n0,0,0\n1,0,0\n", {"unknown column 'WRIST_x'"});
}

TEST(MotionFile, RefusesWhatTheRobotCannotDo) {
  const Project project = MotionProject();
  const JointLimits limits = project.tree.joints[FindJoint(project.tree, "elbow_joint")].limits;
  ASSERT_TRUE(std::isfinite(limits.upper));
  ExpectMotionError("time,elbow_joint\n0,0\n1,90\n", {"m.csv:3: ", "degrees"});
  ExpectMotionError("time,elbow_joint\n0,0\n9," + std::to_string(limits.upper + 0.1) + "\n",
                    {"m.csv:3: ", "elbow_joint", "limits"});
  ExpectMotionError("time,elbow_joint\n0,0\n0.001,0.1\n",
                    {"m.csv:3: ", "elbow_joint", "moves by 100 rad/s"});
}

}  // namespace
}  // namespace elastocal
