// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/posture_table.hpp"

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include <gtest/gtest.h>

#include "elastocal/files/output_files.hpp"
#include "elastocal/readers/qtm_tsv.hpp"
#include "elastocal/robot/robot_tree.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/recording_writers.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

/// Markers A and B are on the forearm, which rail, turret, shoulder and elbow move. T is on the
/// tool.
Project TableProject(const std::string& recording = "{}") {
  return ParseProject(
      "robot: {urdf: arm6.urdf}\n"
      "markers:\n"
      "  single:\n"
      "    - {name: A, link: forearm, position_mm: [10, 20, 30]}\n"
      "    - {name: B, link: forearm, position_mm: [-10, 20, 30]}\n"
      "    - {name: T, link: tool, position_mm: [50, 20, 30]}\n"
      "recording: " +
          recording,
      SourceFile("tests/robots/p.yaml"));
}

const std::string kTableHeader =
    "t,A_x,A_y,A_z,rail_joint,turret_joint,shoulder_joint,elbow_joint\n";

PostureTable ReadTable(const std::string& text, const Project& project = TableProject()) {
  std::istringstream stream(text);
  return ReadPostureTable(stream, "t.csv", project);
}

TEST(PostureTable, GravityIsWhereTheProjectSays) {
  const std::string row = "0,0.1,0.2,0.3,0,0,0,0\n1,0.2,0.2,0.3,0.1,0,0,0\n";
  EXPECT_EQ(ReadTable(kTableHeader + row).recording.gravity, Eigen::Vector3d(0, 0, -9.81));
  EXPECT_EQ(ReadTable(kTableHeader + row, TableProject("{up: x}")).recording.gravity,
            Eigen::Vector3d(-9.81, 0, 0));
}

void ExpectTableError(const std::string& text, std::initializer_list<std::string> parts) {
  ExpectInputError([&] { ReadTable(text); }, parts);
}

TEST(PostureTable, ReadsPostures) {
  const PostureTable table = ReadTable(
      kTableHeader + "1.5,1,2,3,0.1,0.2,0.3,0.4\n2.5,1.5,2.5,-3e-1,-0.1,-0.2,-0.3,-0.4\n");
  const Recording& recording = table.recording;
  EXPECT_EQ(recording.source, "t.csv");
  EXPECT_EQ(recording.marker_names, std::vector<std::string>{"A"});
  ASSERT_EQ(recording.posture_count(), 2);
  EXPECT_EQ(MarkerPosition(recording, 1, 0), Eigen::Vector3d(1.5, 2.5, -0.3));
  const RobotTree tree = TableProject().tree;
  const int elbow = tree.joints[FindJoint(tree, "elbow_joint")].coordinate;
  EXPECT_EQ(recording.q(0, elbow), 0.4);
  EXPECT_EQ(recording.q.cols(), tree.coordinate_count());
  EXPECT_EQ(recording.time_s, Eigen::Vector2d(1.5, 2.5));
  EXPECT_EQ(recording.line, (std::vector<int>{2, 3}));
  EXPECT_EQ(table.markers_not_recorded, (std::vector<std::string>{"B", "T"}));
  EXPECT_EQ(
      recording.joints_not_recorded,
      (std::vector<std::string>{"roll_joint", "bend_joint", "flange_joint", "finger_left_joint"}));
  EXPECT_TRUE(table.warnings.empty());
}

TEST(PostureTable, ReadsRenamedColumnsInAnyOrder) {
  const Project project = TableProject(
      "{columns: {time: stamp, markers: {A: [x, y, z]}, joints: {elbow_joint: q4}}, "
      "ignore: [note, B_x], not_recorded_mm: {rail_joint: 250}}");
  const PostureTable table = ReadTable(
      "\xEF\xBB\xBF"
      "\"q4\";note;z;y;x;turret_joint;shoulder_joint;B_x\r\n"
      "0.4;any text;3;2;1;0.2;0.3;\r\n\r\n",
      project);
  EXPECT_EQ(MarkerPosition(table.recording, 0, 0), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(table.recording.time_s.size(), 0);
  const auto q = [&](const std::string& joint) {
    return table.recording.q(0, project.tree.joints[FindJoint(project.tree, joint)].coordinate);
  };
  EXPECT_EQ(q("elbow_joint"), 0.4);
  EXPECT_EQ(q("rail_joint"), 0.25);
  EXPECT_EQ(table.recording.joints_not_recorded[0], "rail_joint");
}

/// Mimic joints and joints that move no recorded marker need no column.
TEST(PostureTable, FindsEveryKindOfColumn) {
  const Project project = ParseProject(
      "robot: {urdf: arm6.urdf}\n"
      "markers: {single: [{name: M, link: rail, position_mm: [1, 2, 3]},\n"
      "                   {name: N, link: carriage, position_mm: [1, 2, 3]}]}\n"
      "recording: {columns: {markers: {N: [x, y, z]}, joints: {rail_joint: q}}, ignore: [note]}\n",
      SourceFile("tests/robots/p.yaml"));
  const Recording recording =
      ReadTable("note,z,y,x,q,t,elbow_joint,finger_right_joint\na,3,2,1,0.5,7,0.25,b\n", project)
          .recording;
  EXPECT_EQ(recording.time_s[0], 7.0);
  EXPECT_EQ(recording.marker_names, std::vector<std::string>{"N"});
  EXPECT_EQ(MarkerPosition(recording, 0, 0), Eigen::Vector3d(1, 2, 3));
  // The coordinates are rail, turret, shoulder, elbow, roll, bend, flange and left finger.
  Eigen::RowVectorXd q(8);
  q << 0.5, 0, 0, 0.25, 0, 0, 0, 0;
  EXPECT_EQ(recording.q, q);
  EXPECT_EQ(recording.joints_not_recorded.size(), 6u);
}

TEST(PostureTable, EmptyMarkerCellsMeanNotSeen) {
  const std::string header =
      "A_x,A_y,A_z,B_x,B_y,B_z,rail_joint,turret_joint,shoulder_joint,"
      "elbow_joint,finger_right_joint\n";
  const PostureTable table = ReadTable(header + ",,,,,,0,0,0,0,1\n1,2,3,,,,0,0,0,0.1,1\n");
  EXPECT_EQ(table.recording.marker_names, std::vector<std::string>{"A"});
  EXPECT_FALSE(Seen(table.recording, 0, 0));
  EXPECT_TRUE(Seen(table.recording, 1, 0));
  EXPECT_EQ(table.markers_not_recorded, (std::vector<std::string>{"B", "T"}));
  ASSERT_FALSE(table.warnings.empty());
  EXPECT_EQ(table.warnings[0], "marker B was never seen and is left out");
  // pandas writes such cells with na_rep.
  const PostureTable nan =
      ReadTable(header + "NaN,nan,NaN,,,,0,0,0,0,1\n1,2,3,NaN,NaN,NaN,0,0,0,0.1,1\n");
  EXPECT_FALSE(Seen(nan.recording, 0, 0));
  EXPECT_TRUE(Seen(nan.recording, 1, 0));
  EXPECT_EQ(nan.markers_not_recorded, (std::vector<std::string>{"B", "T"}));
  ExpectTableError(header + "1,2,3,NaN,NaN,NaN,0,NaN,0,0,0\n",
                   {"t.csv:2: ", "'turret_joint'", "'NaN'"});
  ExpectTableError(header + ",,,,,,0,0,0,0,0\n", {"t.csv", "no marker was seen"});
  ExpectTableError(header + "1,,3,,,,0,0,0,0,0\n", {"t.csv:2: ", "'A_y'", "found nothing"});
}

TEST(PostureTable, NamesWrongColumns) {
  ExpectTableError("", {"t.csv", "empty"});
  ExpectTableError("A_x,A_y,A_zz\n",
                   {"t.csv:1: ", "'A_zz'", "did you mean 'A_z'", "recording.ignore"});
  ExpectTableError("A_x,A_y,A_x,A_z\n", {"t.csv:1: ", "'A_x' comes twice"});
  ExpectTableError("A_x,A_z,rail_joint\n", {"t.csv:1: ", "'A_y' of marker 'A' is missing"});
  ExpectTableError("t,rail_joint\n", {"t.csv:1: ", "no column of any marker", "'A_x'"});
  ExpectTableError("A_x,A_y,A_z,rail_joint,turret_joint,shoulder_joint\n",
                   {"t.csv:1: ", "'elbow_joint'", "moves marker 'A'", "not_recorded_deg"});
  ExpectTableError("A_x,A_y,A_z\n", {"'rail_joint'", "not_recorded_mm"});
  ExpectTableError("0.1,0.2\n", {"t.csv:1: ", "number '0.1'", "header row"});
  ExpectTableError("# my arm\nA_x,A_y,A_z\n", {"t.csv:1: ", "'# my arm'", "comment are not taken"});
  ExpectInputError([] { ReadTable("x\n", TableProject("{columns: {time: A_x}}")); },
                   {"p.yaml", "'A_x' stands for two things"});
}

TEST(PostureTable, NamesWrongCells) {
  ExpectTableError(kTableHeader, {"t.csv", "no row"});
  ExpectTableError(kTableHeader + "1,1,2,3,0.1,0.2,0.3\n", {"t.csv:2: ", "7 cells", "8"});
  ExpectTableError(kTableHeader + "1,1,5,2,0,3,0,0,1,0,2,0,3,0,4\n",
                   {"15 cells", "8; decimal commas?"});
  ExpectTableError("A_x,A_y,A_z,,t\n", {"t.csv:1: empty column name, cell 4"});
  const auto row = [](const std::string& x, const std::string& q) {
    return kTableHeader + "1,1,2,3,0,0,0,0\n1," + x + ",2,3,0,0,0," + q + "\n";
  };
  ExpectTableError(row("abc", "0"), {"t.csv:3: ", "'A_x'", "'abc'", "finite number"});
  ExpectTableError(row("nan", "0"), {"t.csv:3: ", "'A_x'", "'nan'"});
  ExpectTableError(row("1", "NaN"), {"t.csv:3: ", "'elbow_joint'", "'NaN'"});
  ExpectTableError(row("1", "inf"), {"t.csv:3: ", "'elbow_joint'", "'inf'"});
  ExpectTableError(row("1", ""), {"t.csv:3: ", "'elbow_joint'", "found nothing"});
  ExpectTableError(row("\"1,5\"", "0"), {"t.csv:3: ", "'1,5'", "decimal point"});
}

TEST(PostureTable, SaysWhatARecordingOverTimeNeeds) {
  const Project project = TableProject("{}");
  const auto refused = [&](const std::filesystem::path& file, const std::string& format) {
    ExpectInputError([&] { ReadPostureTable(file, project); },
                     {file.string(), "recording over time (" + format, "experiment.yaml"});
  };
  const ScratchFolder scratch;
  MarkerTrajectories markers{"made", {"A"}, 10.0, Eigen::MatrixXd::Constant(20, 3, 0.5)};
  refused(scratch.Write("a.trc", TrcText(markers)), "TRC");
  refused(scratch.Write("a.tsv", FormatQtmTsv(markers, 3)), "Qualisys TSV");
  refused(SourceFile("tests/recordings/bag.db3"), "ROS 2 bag (db3)");
  refused(SourceFile("tests/recordings/joints_matrix.npz"), "NumPy .npz");
}

TEST(PostureTable, SaysWhatAJointLogNeeds) {
  ExpectTableError("t,elbow_joint,elbow_joint_torque\n0,0.1,2\n",
                   {"t.csv:1", "joint log", "folder with experiment.yaml"});
  // An unknown column in a posture table gets the usual message.
  ExpectTableError("t,A_x,A_y,A_z,elbow_joint,elbow_joint_torque\n0,1,2,3,0.1,2\n",
                   {"unknown column 'elbow_joint_torque'"});
}

TEST(PostureTable, SuspectsMillimetresAndDegrees) {
  // The arm reaches less than 2 m. A hand that moves by 400 mm does not move by 400 m.
  ExpectTableError(kTableHeader + "1,100,2,3,0,0,0,0\n1,500,2,3,0,0,0,0.1\n",
                   {"t.csv", "marker 'A'", "400 m along x", "millimetres"});
  EXPECT_NO_THROW(ReadTable(kTableHeader + "1,1000,2,3,0,0,0,0\n1,1000.4,2,3,0,0,0,0.1\n"));
  ExpectTableError(kTableHeader + "1,1,2,3,0,0,0,0\n1,1,2,3,0,0,0,-45\n",
                   {"t.csv:3: ", "'elbow_joint'", "-45", "degrees"});
}

TEST(PostureTable, WarnsOfJointsBeyondTheirLimits) {
  // The elbow turns by +-2.3 rad and the rail slides from -0.5 to 0.6 m. A degree and 5 mm beyond
  // are allowed.
  const PostureTable table =
      ReadTable(kTableHeader + "1,1,2,3,0.604,0,0,2.31\n1,1,2,3,0.7,0,0,2.4\n1,1,2,3,0,0,0,-2.5\n");
  ASSERT_EQ(table.warnings.size(), 2u);
  EXPECT_EQ(table.warnings[0],
            "t.csv:3: joint 'rail_joint' is at 0.7 m, 100 mm beyond its limit of 0.6 m");
  EXPECT_EQ(table.warnings[1],
            "t.csv:4: joint 'elbow_joint' is at -2.5 rad, 11.4592 degrees beyond its limit of -2.3 "
            "rad (the worst of 2 postures beyond it)");
}

TEST(PostureTable, WarnsOfRepeatedRows) {
  const std::string row = "1,2,3,0,0,0,0.1\n";
  const PostureTable table =
      ReadTable(kTableHeader + "1," + row + "2," + row + "3,1,2,3,0,0,0,0.2\n");
  ASSERT_EQ(table.warnings.size(), 1u);
  EXPECT_EQ(table.warnings[0].rfind("t.csv: line 3 repeats line 2: ", 0), 0u);
  ExpectTableError(kTableHeader + "1," + row + "2," + row,
                   {"t.csv: the 2 postures are all the same"});
}

TEST(PostureTable, RefusesIdenticalMarkers) {
  const std::string header =
      "A_x,A_y,A_z,B_x,B_y,B_z,rail_joint,turret_joint,shoulder_joint,elbow_joint\n";
  ExpectTableError(header + "1,2,3,1,2,3,0,0,0,0\n4,2,3,4,2,3,0,0,0,1\n,,,,,,0,0,0,1\n",
                   {"t.csv", "'A' and 'B'", "identical"});
  EXPECT_NO_THROW(ReadTable(header + "1,2,3,1,2,3,0,0,0,0\n4,2,3,4,2,3.1,0,0,0,1\n"));
}

// Many programs write zeros for an unseen marker. But a marker that is at zero in all postures may
// define the frame.
TEST(PostureTable, MarkersAtExactlyZeroAreNotSeen) {
  const std::string header =
      "A_x,A_y,A_z,B_x,B_y,B_z,rail_joint,turret_joint,shoulder_joint,"
      "elbow_joint,finger_right_joint\n";
  const PostureTable table =
      ReadTable(header + "1,2,3,0,0,0,0,0,0,0,1\n0,0.0,0.000,0,0,0,0,0,0,0.1,1\n");
  EXPECT_TRUE(Seen(table.recording, 0, 0));
  EXPECT_FALSE(Seen(table.recording, 1, 0));
  EXPECT_TRUE(Seen(table.recording, 1, 1));
  ASSERT_FALSE(table.warnings.empty());
  EXPECT_EQ(table.warnings[0],
            "marker A: taken as not seen where it is at exactly 0 0 0 (1 postures, the first on "
            "line 3)");
}

/// Large files of zeros in several shapes. Each is refused by the first check that applies.
TEST(PostureTable, RefusesALargeFileOfZeros) {
  const ScratchFolder scratch;
  const std::filesystem::path file = scratch.path() / "zeros.csv";
  const auto write = [&](const std::string& head, const std::string& piece) {
    std::ofstream stream(file, std::ios::binary);
    stream << head;
    std::string block;
    while (block.size() < 1 << 20) block += piece;
    for (int i = 0; i < 8; ++i) stream << block;
  };
  const auto read = [&] { ReadPostureTable(file, TableProject()); };
  write("", "0");
  ExpectInputError(read, {"zeros.csv:1: ", "1 MiB"});
  write("", std::string(1, '\0'));
  ExpectInputError(read, {"zeros.csv:1: ", "NUL"});
  write("", "0\n");
  ExpectInputError(read, {"zeros.csv:1: ", "header row"});
  write(kTableHeader, "0\n");
  ExpectInputError(read, {"zeros.csv:2: ", "1 cells"});
  write(kTableHeader, "0,0,0,0,0,0,0,0\n");
  ExpectInputError(read, {"zeros.csv:100002: ", "more than 100000 rows"});
}

TEST(PostureTable, NamesAFileThatCannotBeRead) {
  ExpectInputError([] { ReadPostureTable("nowhere/t.csv", TableProject()); },
                   {"nowhere/t.csv", "there is no such file"});
  ExpectInputError(
      [] { ReadPostureTable(std::filesystem::path(testing::TempDir()), TableProject()); },
      {"is a folder"});
  const ScratchFolder scratch;
  const std::filesystem::path file = scratch.path() / "t.csv";
  WriteFile(file, kTableHeader);
  std::filesystem::permissions(file, std::filesystem::perms::none);
  if (std::ifstream(file)) GTEST_SKIP() << "this user may read everything";
  ExpectInputError([&] { ReadPostureTable(file, TableProject()); },
                   {"t.csv: cannot be read: Permission denied"});
}

TEST(PostureTable, RefusesOneMarkerInAnotherUnit) {
  const Project project = ParseProject(
      "robot: {urdf: arm6.urdf}\n"
      "markers: {single: [{name: M, link: carriage, position_mm: [0, 0, 0]},\n"
      "                   {name: N, link: carriage, position_mm: [90, 0, 0]},\n"
      "                   {name: O, link: carriage, position_mm: [0, 60, 0]}]}\n"
      "recording: {columns: {joints: {rail_joint: q}}}\n",
      SourceFile("tests/robots/p.yaml"));
  ExpectInputError(
      [&] {
        ReadTable(
            "M_x,M_y,M_z,N_x,N_y,N_z,O_x,O_y,O_z,q\n"
            "1,1,0.5,0.00109,0.001,0.0005,1,1.06,0.5,0.1\n"
            "1.2,1,0.5,0.00129,0.001,0.0005,1.2,1.06,0.5,0.3\n",
            project);
      },
      {"t.csv", "marker N", "1000 times too small"});
  // Distances also tell a marker whose coordinates range over more than the robot's size.
  ExpectInputError(
      [&] {
        ReadTable(
            "M_x,M_y,M_z,N_x,N_y,N_z,O_x,O_y,O_z,q\n"
            "1,1,0.5,1090,1000,500,1,1.06,0.5,0.1\n"
            "1.2,1,0.5,1290,1000,500,1.2,1.06,0.5,0.3\n",
            project);
      },
      {"t.csv", "marker N", "1000 times too large"});
}

TEST(PostureTable, WritesWhatItReads) {
  const ScratchFolder scratch;
  const std::filesystem::path file = scratch.path() / "written.csv";
  const Project project = TableProject();
  const Recording first =
      ReadTable(kTableHeader +
                "1.5,,,,0.1,0.2,0.3,0.4\n2.5,0.1,0.333333333333333315,-3e-1,-0.1,0,0,0\n")
          .recording;
  WritePostureTable(file, first, project.tree);
  const Recording second = ReadPostureTable(file, project).recording;
  EXPECT_EQ(second.marker_names, first.marker_names);
  EXPECT_EQ(second.q, first.q);
  EXPECT_EQ(second.time_s, first.time_s);
  EXPECT_EQ(second.joints_not_recorded, first.joints_not_recorded);
  EXPECT_FALSE(Seen(second, 0, 0));
  EXPECT_EQ(second.markers.row(1), first.markers.row(1));
  const Project renamed = TableProject(
      "{columns: {time: seconds, markers: {A: [X, Y, Z]}, joints: {elbow_joint: axis 4}}}");
  WritePostureTable(file, first, renamed);
  const Recording third = ReadPostureTable(file, renamed).recording;
  EXPECT_EQ(third.q, first.q);
  EXPECT_EQ(third.time_s, first.time_s);
  EXPECT_EQ(third.markers.row(1), first.markers.row(1));
}

TEST(PostureTable, NamesWithSeparatorsAndQuotesSurvive) {
  const ScratchFolder scratch;
  const Project project = ParseProject(
      "robot: {urdf: arm6.urdf}\n"
      "markers:\n"
      "  single:\n"
      "    - {name: \"A, left; low\", link: forearm, position_mm: [10, 20, 30]}\n"
      "    - {name: 'B \"old\"', link: forearm, position_mm: [-10, 20, 30]}\n",
      SourceFile("tests/robots/p.yaml"));
  Recording recording;
  recording.marker_names = {"A, left; low", "B \"old\""};
  recording.q = Eigen::MatrixXd::Zero(2, project.tree.coordinate_count());
  recording.q(1, 0) = 0.1;
  recording.markers.resize(2, 6);
  recording.markers << 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.2, 0.2, 0.3, 0.5, 0.5, 0.6;
  const std::filesystem::path file = scratch.path() / "named.csv";
  WritePostureTable(file, recording, project.tree);
  const Recording read = ReadPostureTable(file, project).recording;
  EXPECT_EQ(read.marker_names, recording.marker_names);
  EXPECT_EQ(read.markers, recording.markers);
}

TEST(PostureTable, ReadsTheMeasuredRecording) {
  const auto file = SharedFile("data/talos_left_arm_mocap/talos_left_arm_02_10_contact.csv");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
  const Project project = ReadProject(SourceFile("examples/talos_left_arm/project.yaml"));
  const PostureTable table = ReadPostureTable(file, project);
  EXPECT_EQ(table.recording.posture_count(), 61);
  EXPECT_EQ(table.recording.marker_count(), 1);
  EXPECT_EQ(table.recording.joints_not_recorded.size(), 21u);
  EXPECT_TRUE(table.warnings.empty());
}

}  // namespace
}  // namespace elastocal
