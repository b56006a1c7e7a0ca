// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include <gtest/gtest.h>

#include "elastocal/io/observation_table.hpp"
#include "elastocal/tables/text.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/posture_text.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

/// A project with one instrument of each kind and no plates.
const char* const kInstruments = R"(
instruments:
  trackers: [{name: room}]
  planes: [{name: wall, normal: [1, 0, 0]}]
  poses: [{name: hand, link: arm_left_7_link, tracker: room}]
  positions: [{name: ball, link: arm_right_7_link, tracker: room, columns: [bx, by, bz]}]
  inertial_units: [{name: imu, link: base_link, rpy_deg: [0, 180, 0]}]
  distances: [{name: tip, link: arm_left_7_link, plane: wall}]
  wires: [{name: wire, link: arm_left_7_link, anchor_mm: [2000, 0, 0]}]
recording: {ignore: [note]}
)";

Project InstrumentProject(const std::string& from = "", const std::string& to = "") {
  std::string text =
      "robot: {urdf: " + SourceFile("models/talos/talos.urdf").string() + "}\n" + kInstruments;
  if (!from.empty()) text.replace(text.find(from), from.size(), to);
  return ParseProject(text, "project.yaml");
}

TEST(InstrumentInput, TheProjectSaysWhatIsWrong) {
  const auto error = [](const std::string& from, const std::string& to,
                        const std::string& message) {
    ExpectInputError([&] { InstrumentProject(from, to); }, {"project.yaml:", message});
  };
  error("poses:", "posse:", "did you mean 'poses'?");
  error("arm_right_7_link", "arm_rihgt_7_link", "did you mean 'arm_right_7_link'?");
  error("arm_left_7_link, tracker: room", "arm_left_7_link, tracker: rom", "did you mean 'room'?");
  error("plane: wall", "plane: wal", "did you mean 'wall'?");
  error("name: imu", "name: hand", "a second instrument of the name 'hand'");
  error("[bx, by, bz]", "[bx, by]", "3 columns");
  error("normal: [1, 0, 0]", "normal: [0, 0, 0]", "a direction");
  error("rpy_deg: [0, 180, 0]", "rpy_deg: [0, 1800, 0]", "from -720 to 720");
  error("anchor_mm: [2000, 0, 0]", "anchor_m: [2, 0, 0]", "did you mean 'anchor_mm'?");
  error("link: arm_left_7_link, tracker: room}",
        "link: arm_left_7_link, tracker: room, covariance: [[1]]}", "six rows");
}

/// A table in which all instruments have values in the first row. `cells` replaces cells.
std::string InstrumentTable(const Project& project, const std::string& from = "",
                            const std::string& to = "") {
  std::string text = TableText(
      project, 3, "",
      "hand_x,hand_y,hand_z,hand_qx,hand_qy,hand_qz,hand_qw,bx,by,bz,imu_ax,imu_ay,imu_az,tip,"
      "wire,note");
  const std::string cells = "0.1,0.2,0.3,0,0.6,0,0.8,1,2,3,0.2,0.1,9.8,0,1.5,a\n";
  text.replace(text.find(",a\n") + 1, 2, cells);
  for (std::size_t at;
       (at = text.find(",a\n", text.find(cells) + cells.size())) != std::string::npos;) {
    text.replace(at + 1, 1, ",,,,,,,,,,,,,,,b");
  }
  if (!from.empty())
    text.replace(text.rfind(from, text.find(cells) + cells.size()), from.size(), to);
  return text;
}

TEST(InstrumentInput, ATableHoldsWhatAllInstrumentsShow) {
  const Project project = InstrumentProject();
  ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "t.csv";
  std::ofstream(file) << InstrumentTable(project);
  const ObservationTables tables = ReadObservationTables({file}, project);
  ASSERT_EQ(tables.observations.count(), 5);
  EXPECT_EQ(tables.observations.posture_count(), 3);
  EXPECT_EQ(tables.observations.all[0].measured.tail<2>(), Eigen::Vector2d(0.0, 0.8));
  EXPECT_EQ(tables.observations.all[1].measured, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(tables.setup.instruments[2]->name, "imu");
  EXPECT_EQ(tables.observations.effects.size(), 1u);  // the wall's effect
}

TEST(InstrumentInput, TheTableSaysWhatIsWrong) {
  const Project project = InstrumentProject();
  ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "t.csv";
  const auto error = [&](const std::string& from, const std::string& to,
                         std::initializer_list<std::string> messages) {
    std::ofstream(file) << InstrumentTable(project, from, to);
    ExpectInputError([&] { ReadObservationTables({file}, project); }, messages);
  };
  error("0,0.8", "0,0.81", {"t.csv:2: ", "hand_qx", "length 1.008", "0.001"});
  error("0.2,0.3,0,", "0.2,,0,", {"t.csv:2: ", "hand_z", "all or none"});
  error("0.2,0.1,9.8", "0.02,0.01,1", {"t.csv:2: ", "imu_ax", "units of gravity"});
  error("0.2,0.1,9.8", "0.02,0.01,5", {"t.csv:2: ", "at rest"});
  error("1,2,3", "1000,2000,3000", {"t.csv:2: ", "bx", "in mm?"});
  error("1,2,3", "1,x,3", {"t.csv:2: ", "by", "'x'"});
  error(",1.5,a", ",-1.5,a", {"t.csv:2: ", "'wire'", "opposite sign"});
  error("hand_qw", "hand_w", {"hand_w"});
  error("hand_qw,", "note,", {"hand_qw"});
  std::ofstream(file) << TableText(project, 3);
  ExpectInputError([&] { ReadObservationTables({file}, project); },
                   {"no column of any instrument", "hand_x"});
  const Project posed = InstrumentProject();
  std::string missing = InstrumentTable(posed);
  missing.replace(missing.find("arm_left_3_joint"), 16, "note");
  std::ofstream(file) << missing;
  ExpectInputError([&] { ReadObservationTables({file}, posed); }, {"arm_left_3_joint"});
}

TEST(InstrumentInput, ImagesOfTagsAreReadFromATableOfCorners) {
  const std::string text = "robot: {urdf: " + SourceFile("models/talos/talos.urdf").string() + R"(}
instruments:
  cameras: [{name: head, link: head_2_link, focal_px: [600, 600], centre_px: [320, 240]}]
  tags: [{name: "7", link: arm_left_7_link, size_mm: 50}, {name: pole, size_mm: 200}]
recording: {ignore: [note]}
)";
  const Project project = ParseProject(text, "project.yaml");
  ScratchFolder folder;
  const std::filesystem::path table = folder.path() / "t.csv";
  const std::filesystem::path corners = folder.path() / "corners.csv";
  std::string postures = TableText(project, 2, "", "frame,note");
  postures.replace(postures.find(",a\n"), 3, ",f0,a\n");
  postures.replace(postures.rfind(",a\n"), 3, ",f1,a\n");
  std::ofstream(table) << postures;
  const std::string fine = "frame,tag,corner,u,v\nf1,7,0,1,2\nf1,7,1,3,4\nf1,7,2,5,6\nf1,7,3,7,8\n";
  const auto read = [&](std::string of, const std::string& from, const std::string& to) {
    of.replace(of.find(from), from.size(), to);
    std::ofstream(corners) << of;
    return ReadObservationTables({table, corners}, project);
  };
  const ObservationTables tables = read(fine, "f1", "f1");
  ASSERT_EQ(tables.observations.count(), 1);
  EXPECT_EQ(tables.observations.all[0].posture, 1);
  EXPECT_EQ(tables.observations.all[0].measured[5], 6.0);
  EXPECT_EQ(tables.setup.instruments[0]->name, "head/7");
  std::string twice = text;
  twice.replace(twice.find("instruments:"), 12,
                "instruments:\n  trackers: [{name: t}]\n"
                "  poses: [{name: \"7\", link: base_link, tracker: t}]");
  ExpectInputError([&] { ParseProject(twice, "project.yaml"); },
                   {"project.yaml:", "two things", "'7.mounting'"});
  const auto error = [&](const std::string& from, const std::string& to,
                         std::initializer_list<std::string> messages) {
    ExpectInputError([&] { read(fine, from, to); }, messages);
  };
  error("f1,7,0", "f1,pale,0", {"corners.csv:2: ", "'tag'", "did you mean 'pole'?"});
  error("f1,7,0", "f1,8,0", {"corners.csv:2: ", "no tag '8'; known: 7, pole"});
  error("1,2\nf1,7,1,3,4\nf1,7,2,5,6\nf1,7,3,7,8",
        "0.1,0.2\nf1,7,1,0.3,0.2\nf1,7,2,0.3,0.3\nf1,7,3,0.1,0.3", {"corners.csv", "from 0 to 1"});
  error("f1,7,1", "f1,7,0", {"corners.csv:3: ", "comes twice"});
  error("f1,7,1", "f1,7,4", {"corners.csv:3: ", "0, 1, 2 or 3"});
  error("f1,7,3,7,8\n", "", {"corners.csv:2: ", "not all of its four corners"});
  error("f1,7,0", "f2,7,0", {"not all of its four corners"});
  error(",u,v", ",u,w", {"corners.csv", "w"});
  error("1,2\n", "1,x\n", {"corners.csv:2: ", "'x'"});
  std::ofstream(corners) << fine;
  ExpectInputError([&] { ReadObservationTables({corners}, project); },
                   {"this is a table of corners", "frame"});
  std::ofstream(table) << postures.replace(postures.rfind("f1"), 2, "f0");
  ExpectInputError(
      [&] {
        ReadObservationTables({table, corners}, project);
      },
      {"a second row has frame 'f0'"});
}

}  // namespace
}  // namespace elastocal
