// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/joint_log.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "elastocal/files/output_files.hpp"
#include "elastocal/io/recorded_files.hpp"
#include "elastocal/tables/text.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

Project LogProject(const std::string& recording = "{}", const std::string& more = "") {
  return ParseProject(
      "robot: {urdf: arm6.urdf}\n"
      "markers: {single: [{name: A, link: tool, position_mm: [10, 20, 30]}]}\n"
      "recording: " +
          recording + "\n" + more,
      SourceFile("tests/robots/p.yaml"));
}

JointLog ReadLog(const std::string& text, const Project& project = LogProject(),
                 const std::string& time_unit = "") {
  std::istringstream stream(text);
  return ReadJointLog(stream, "j.csv", project, time_unit);
}

void ExpectLogError(const std::string& text, std::initializer_list<std::string> parts) {
  ExpectInputError([&] { ReadLog(text); }, parts);
}

TEST(JointLog, ReadsPositionsAndTorques) {
  const JointLog log = ReadLog(
      "elbow_joint_torque,t,elbow_joint,rail_joint_position,rail_joint_effort,turret_joint,"
      "turret_joint_velocity,gone_velocity,finger_right_joint,finger_right_joint_torque\n"
      "-5,100.5,0.1,0.2,7,0.3,x,y,z,w\n-6,100.75,-1.1,1e-3,8,0.4,,,,\n");
  EXPECT_EQ(log.source, "j.csv");
  EXPECT_EQ(log.names, (std::vector<std::string>{"elbow_joint", "rail_joint", "turret_joint"}));
  EXPECT_EQ(log.sample_count(), 2);
  EXPECT_EQ(log.time_s, Eigen::Vector2d(100.5, 100.75));
  EXPECT_EQ(log.positions.row(0), Eigen::RowVector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(log.positions.row(1), Eigen::RowVector3d(-1.1, 1e-3, 0.4));
  EXPECT_EQ(log.torques.leftCols(2), (Eigen::Matrix2d() << -5, 7, -6, 8).finished());
  EXPECT_TRUE(log.torques.col(2).array().isNaN().all());
}

// PlotJuggler exports a topic of joint states like this.
TEST(JointLog, ReadsNamesThatArePathsOfATopic) {
  const JointLog log = ReadLog(
      "__time,/joint_states/elbow_joint/effort,/joint_states/elbow_joint/position,"
      "/joint_states/elbow_joint/velocity,/joint_states/header/seq,/j/rail_joint/position\n"
      "100.5,-5,0.1,,7,0.2\n100.75,-6,0.2,,8,0.3\n");
  EXPECT_EQ(log.names, (std::vector<std::string>{"elbow_joint", "rail_joint"}));
  EXPECT_EQ(log.time_s, Eigen::Vector2d(100.5, 100.75));
  EXPECT_EQ(log.positions, (Eigen::Matrix2d() << 0.1, 0.2, 0.2, 0.3).finished());
  EXPECT_EQ(log.torques.col(0), Eigen::Vector2d(-5, -6));
  ExpectLogError("__time,/joint_states/elbow_joint/position,/joint_states/wrist/position\n0,1,2\n",
                 {"unknown column '/joint_states/wrist/position'"});
  ExpectLogError("__time,/joint_states/elbow_joint/position,elbow_joint\n0,1,2\n", {"elbow_joint"});
}

// Some loggers write empty rows until the robot answers.
TEST(JointLog, EmptyRowsAboveTheFirstSampleArePassedOver) {
  const std::string begin = "time,elbow_joint,elbow_joint_torque,turret_joint\n\n0.5,,,\n,nan,,\n";
  const JointLog log = ReadLog(begin + "1,0.1,5,0.2\n2,0.2,6,0.3\n");
  EXPECT_EQ(log.time_s, Eigen::Vector2d(1.0, 2.0));
  EXPECT_EQ(log.positions.row(0), Eigen::RowVector2d(0.1, 0.2));
  ExpectLogError(begin + "1,0.1,5,0.2\n2,,,\n", {"j.csv:6: ", "'elbow_joint'", "found nothing"});
  ExpectLogError(begin + "1,0.1,5,\n", {"j.csv:5: ", "'turret_joint'"});
  ExpectLogError(begin, {"no row below the header has a position"});
}

TEST(JointLog, ReadsAndWritesForceTorqueSensors) {
  const Project project = LogProject(
      "{}", "force_torque_sensors: [{name: base, link: pedestal}, {name: tip, link: tool}]");
  const JointLog log = ReadLog(
      "t,tip_tz,elbow_joint,tip_fx,tip_fy,tip_fz,tip_tx,tip_ty\n1,6,0.5,1,2,3,4,5\n"
      "2,-6,0.5,-1,-2,-3,-4,-5\n",
      project);
  ASSERT_EQ(log.wrench_sensors.size(), 1u);
  EXPECT_EQ(log.wrench_sensors[0].name, "tip");
  EXPECT_EQ(log.wrench_sensors[0].link, FindLink(project.tree, "tool"));
  ASSERT_EQ(log.wrenches.rows(), 2);
  const Eigen::RowVectorXd expected = Eigen::RowVectorXd::LinSpaced(6, 1.0, 6.0);
  EXPECT_EQ(log.wrenches.row(0), expected);
  EXPECT_EQ(log.wrenches.row(1), -expected);
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "wrenches.csv";
  WriteJointLog(file, log);
  EXPECT_EQ(ReadJointLog(file, project).wrenches, log.wrenches);
  std::filesystem::remove(file);
  ExpectInputError([&] { ReadLog("t,elbow_joint,tip_fx\n1,2,3\n", project); },
                   {"j.csv:1: ", "'tip_fy' of force-torque sensor 'tip' is missing", "'tip_fx'"});
  ExpectInputError([&] { ReadLog("t,elbow_joint,tip_fa\n1,2,3\n", project); },
                   {"'tip_fa'", "did you mean 'tip_f"});
  EXPECT_EQ(ReadLog("t,elbow_joint\n1,2\n", project).wrenches.size(), 0);
}

TEST(JointLog, UsesTheNamesOfTheProject) {
  const Project project = LogProject(
      "{columns: {time: stamp, joints: {elbow_joint: q4}}, ignore: [mode, turret_joint_torque]}");
  const JointLog log = ReadLog(
      "stamp;mode;q4_position;q4_torque;turret_joint;turret_joint_torque\r\n"
      "1;idle;0.4;9;0.5;broken\r\n",
      project);
  EXPECT_EQ(log.names, (std::vector<std::string>{"elbow_joint", "turret_joint"}));
  EXPECT_EQ(log.torques(0, 0), 9.0);
  EXPECT_TRUE(std::isnan(log.torques(0, 1)));
  EXPECT_EQ(ReadLog("time,elbow_joint\n2,0.5\n").time_s[0], 2.0);
  ExpectInputError([] { ReadLog("x\n", LogProject("{columns: {time: elbow_joint}}")); },
                   {"p.yaml", "'elbow_joint' stands for two things"});
}

// `info` tells logs from Qualisys TSVs, which begin with the column Time as well.
TEST(JointLog, InfoKnowsTabsAndByteOrderMarks) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "anything";
  const auto format = [&](const std::string& text) {
    WriteFile(file, text);
    const std::string name = ReadAnyRecording(file, {}).format;
    std::filesystem::remove(file);
    return name;
  };
  EXPECT_EQ(format("time\telbow_joint\n0\t0.1\n0.1\t0.2\n"), "joint log (CSV)");
  // A table whose time has another name is no Qualisys TSV.
  EXPECT_EQ(format("Time\telbow_joint\n0\t0.1\n0.1\t0.2\n"), "table (CSV)");
  EXPECT_EQ(format("TIME\telbow_joint\n0\t0.1\n0.1\t0.2\n"), "table (CSV)");
  const std::string rows = "0\t1\t2\t3\n0.1\t4\t5\t6\n";
  EXPECT_EQ(format("Time\tA X\tA Y\tA Z\n" + rows), "Qualisys TSV");
  EXPECT_EQ(format("\xEF\xBB\xBFMARKER_NAMES\tA\nTime\tA X\tA Y\tA Z\n" + rows), "Qualisys TSV");
}

TEST(JointLog, ATorqueColumnWithoutNumbersIsNoSensor) {
  const std::string header = "t,elbow_joint,elbow_joint_torque,rail_joint,rail_joint_torque\n";
  const JointLog log = ReadLog(header + "1,0,nan,0,\n2,0,NaN,0,\n");
  EXPECT_TRUE(log.torques.array().isNaN().all());
  const std::string gap = header + "1,0,5,0,\n2,0,5,0,\n3,0,nan,0,\n4,0,,0,\n";
  const Project sensor = LogProject("{}", "torque_sensors: [elbow_joint]");
  ExpectInputError([&] { ReadLog(gap, sensor); },
                   {"j.csv:4: column 'elbow_joint_torque'", "found no torque", "in any row"});
  // Nobody uses the effort of a joint that is not in torque_sensors.
  EXPECT_TRUE(ReadLog(gap).torques.array().isNaN().all());
}

TEST(JointLog, NamesWrongColumns) {
  ExpectLogError("", {"j.csv", "empty"});
  ExpectLogError("t,elbo_joint\n",
                 {"j.csv:1: ", "'elbo_joint'", "did you mean 'elbow_joint'", "recording.ignore"});
  ExpectLogError("t,elbow_joint,elbow_joint_torqe\n", {"did you mean 'elbow_joint_torque'"});
  ExpectLogError("t,elbow_joint,elbow_joint_position\n",
                 {"j.csv:1: ", "'elbow_joint' and 'elbow_joint_position' stand for the same"});
  ExpectLogError("t,elbow_joint,elbow_joint_torque,elbow_joint_effort\n", {"stand for the same"});
  ExpectLogError("t,time,elbow_joint\n", {"'t' and 'time' stand for the same"});
  ExpectLogError("elbow_joint\n", {"j.csv:1: ", "no column of the time", "'t'"});
  ExpectLogError("t,elbow_joint_velocity\n", {"j.csv:1: ", "no column of any joint"});
  ExpectLogError("t,elbow_joint,rail_joint_torque\n",
                 {"j.csv:1: ", "'rail_joint_torque'", "positions are missing"});
  ExpectLogError("0.1,0.2\n", {"j.csv:1: ", "number '0.1'", "header row"});
}

TEST(JointLog, NamesWrongCells) {
  const std::string header = "t,elbow_joint,elbow_joint_torque\n";
  ExpectLogError(header, {"j.csv", "no row"});
  ExpectLogError(header + "1,0\n", {"j.csv:2: ", "2 cells", "3"});
  ExpectLogError(header + "1,0,0\n2,x,0\n", {"j.csv:3: column 'elbow_joint'", "'x'"});
  ExpectLogError(header + "1,0,0\n2,nan,0\n", {"j.csv:3: column 'elbow_joint'", "'nan'"});
  ExpectLogError(header + "1,0,0\n2,,0\n", {"j.csv:3: column 'elbow_joint'", "found nothing"});
  ExpectLogError(header + "1,0,0\n2,0,inf\n", {"j.csv:3: column 'elbow_joint_torque'", "'inf'"});
  ExpectLogError(header + "1,0,\"0,5\"\n", {"j.csv:2: ", "'0,5'", "decimal point"});
  ExpectLogError(header + "nan,0,0\n", {"j.csv:2: column 't'", "'nan'"});
}

TEST(JointLog, TimeIncreases) {
  const std::string header = "time,elbow_joint\n";
  ExpectLogError(header + "1,0\n2,0\n2,0\n", {"j.csv:4: column 'time'", "2 after 2", "increase"});
  ExpectLogError(header + "1,0\n2,0\n1.5,0\n", {"j.csv:4: ", "1.5 after 2"});
}

// A log of twenty or more rows of which most would be a second or more apart is in another unit.
TEST(JointLog, TimeIsInTheUnitThatIsStated) {
  const auto text = [](const std::string& name, double unit) {
    std::string rows = name + ",elbow_joint\n";
    for (int i = 0; i < 20; ++i) rows += FormatNumber(std::round(0.01 / unit) * i) + ",0.1\n";
    return rows;
  };
  EXPECT_NEAR(ReadLog(text("time_us", 1e-6)).time_s[19], 0.19, 1e-12);
  EXPECT_NEAR(ReadLog(text("stamp", 1e-3), LogProject("{columns: {time: stamp}}"), "ms").time_s[19],
              0.19, 1e-12);
  ExpectLogError(text("t", 1e-9), {"j.csv: most samples would be 1e+07 s apart", "time_unit"});
  EXPECT_EQ(ReadLog(text("t", 1e-3), LogProject(), "s").time_s[19], 190.0);
}

TEST(JointLog, SuspectsDegrees) {
  ExpectLogError("t,elbow_joint\n1,0\n2,-45\n3,12\n",
                 {"j.csv:3: ", "'elbow_joint'", "-45", "degrees"});
  // A prismatic joint is in metres. Two turns are 12.57 rad.
  EXPECT_NO_THROW(ReadLog("t,elbow_joint,rail_joint\n1,12.5,0.5\n"));
  ExpectLogError("t,elbow_joint,rail_joint\n1,12.5,450\n",
                 {"j.csv:2: ", "'rail_joint'", "450", "millimetres; metres were expected"});
}

// A log that counts from -pi to pi jumps by a turn while the joint goes on. A sliding joint may be
// anywhere. Turns during lost rows are unknown.
TEST(JointLog, TurnsAreUnwrapped) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / "elastocal_wrapped_log.csv";
  std::ofstream(file) << "t,elbow_joint,rail_joint\n1,3.0,0.0\n1.01,-3.1,4.0\n1.02,-3.0,0.0\n"
                         "1.03,3.1,0.0\n9.0,-3.1,0.0\n";
  const JointLog log = ReadJointFile(file, {}, LogProject());
  std::filesystem::remove(file);
  const double turn = 2.0 * M_PI;
  Eigen::VectorXd elbow(5), rail(5);
  elbow << 3.0, turn - 3.1, turn - 3.0, 3.1, -3.1;
  rail << 0.0, 4.0, 0.0, 0.0, 0.0;
  EXPECT_LT((log.positions.col(0) - elbow).norm(), 1e-12) << log.positions;
  EXPECT_LT((log.positions.col(1) - rail).norm(), 1e-12);
}

TEST(JointLog, OneThatCountsModuloHalfATurnIsRefused) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / "elastocal_half_turns.csv";
  std::ofstream(file) << "t,elbow_joint,rail_joint\n1,1.55,0.0\n1.01,-1.56,4.0\n1.02,-1.5,0.0\n";
  ExpectInputError([&] { ReadJointFile(file, {}, LogProject()); },
                   {"half_turns.csv", "'elbow_joint'", "half a turn", "1.01"});
  std::filesystem::remove(file);
}

TEST(JointLog, RefusesARecordingWithoutEnd) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "endless.csv";
  std::ofstream stream(file, std::ios::binary);
  stream << "t,elbow_joint\n";
  for (int i = 0; i < 1000010; ++i) stream << i << ",0\n";
  stream.close();
  ExpectInputError([&] { ReadJointLog(file, LogProject()); },
                   {"endless.csv:1000002: ", "more than 1000000 rows"});
  std::filesystem::remove(file);
}

TEST(JointLog, WritesWhatItReads) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / "written_joints.csv";
  const JointLog written = ReadLog(
      "t,elbow_joint,rail_joint,rail_joint_torque\n0.1,0.3333333333333333,1e-17,-7.25\n"
      "0.30000000000000004,2,3,4\n");
  WriteJointLog(file, written);
  EXPECT_EQ(ReadFile(file).substr(0, 44), "t,elbow_joint,rail_joint,rail_joint_torque\n0");
  const JointLog read = ReadJointLog(file, LogProject());
  EXPECT_EQ(read.source, file.string());
  EXPECT_EQ(read.names, written.names);
  EXPECT_EQ(read.time_s, written.time_s);
  EXPECT_EQ(read.positions, written.positions);
  EXPECT_EQ(read.torques.col(1), written.torques.col(1));
  EXPECT_TRUE(read.torques.col(0).array().isNaN().all());
  std::filesystem::remove(file);
}

TEST(JointLog, NamesWithSeparatorsAndQuotesSurvive) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "named_joints.csv";
  const Project project =
      LogProject(R"({columns: {joints: {elbow_joint: "el,bow;;;", rail_joint: 'ra"il'}}})",
                 "force_torque_sensors: [{name: \"tip, right\", link: tool}]");
  JointLog written;
  written.names = {"el,bow;;;", "ra\"il"};
  written.time_s = Eigen::Vector2d(1, 2);
  written.positions = Eigen::Matrix2d::Constant(0.25);
  written.torques = Eigen::Matrix2d::Constant(0.5);
  written.wrench_sensors = project.force_torque_sensors;
  written.wrenches = Eigen::MatrixXd::Constant(2, 6, 3.0);
  WriteJointLog(file, written);
  const JointLog read = ReadJointLog(file, project);
  EXPECT_EQ(read.names, (std::vector<std::string>{"elbow_joint", "rail_joint"}));
  EXPECT_EQ(read.torques, written.torques);
  EXPECT_EQ(read.wrenches, written.wrenches);
  std::filesystem::remove(file);
}

TEST(JointLog, NamesAFileThatCannotBeRead) {
  ExpectInputError([] { ReadJointLog("nowhere/j.csv", LogProject()); },
                   {"nowhere/j.csv", "there is no such file"});
}

}  // namespace
}  // namespace elastocal
