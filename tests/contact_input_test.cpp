// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <functional>
#include <sstream>

#include <gtest/gtest.h>

#include "elastocal/io/contact_file.hpp"
#include "elastocal/io/observation_table.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/tables/text.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

std::string ProjectText(const std::string& contact, const std::string& rest = "") {
  return "robot: {urdf: " + SourceFile("models/talos/talos.urdf").string() + "}\n" + "contact: {" +
         contact + "}\n" + rest;
}

const char* const kFeet = "feet: [{link: left_sole_link}, {link: right_sole_link}], ";
const char* const kPlates = "plates: [{name: left, link: gripper_left_base_link}]";

Project ProjectOf(const std::string& contact, const std::string& rest = "") {
  return ParseProject(ProjectText(contact, rest), "project.yaml");
}

/// A table of `rows` different postures of all joints but those left out.
std::string TableText(const Project& project, int rows, const std::string& without = "",
                      const std::string& extra = "") {
  std::string text;
  for (const Joint& joint : project.tree.joints) {
    if (!joint.mimic && joint.name != without) text += joint.name + ",";
  }
  text += (extra.empty() ? "note" : extra) + "\n";
  Random random(1);
  for (int i = 0; i < rows; ++i) {
    for (const Joint& joint : project.tree.joints) {
      if (!joint.mimic && joint.name != without) {
        text += std::to_string(random.Uniform(-0.1, 0.1)) + ",";
      }
    }
    text += "a\n";
  }
  return text;
}

TEST(ContactInput, TheProjectSaysWhatIsWrong) {
  const auto error = [](const std::string& contact, const std::string& message,
                        const std::string& rest = "") {
    ExpectInputError([&] { ProjectOf(contact, rest); }, {"project.yaml", message});
  };
  error(std::string(kFeet) + "plate: []", "did you mean 'plates'?");
  error("feet: [{link: left_sole_lnk}], " + std::string(kPlates), "did you mean 'left_sole_link'?");
  error("feet: [{link: base_link}], " + std::string(kPlates), "a foot was expected");
  error("feet: [{link: left_sole_link, position_mm: [0, 1, 0]}], " + std::string(kPlates),
        "[0, 0, 0]");
  error(std::string(kFeet) + "plates: [{name: a, link: gripper_left_base_link, normal: [0, 0, 0]}]",
        "a direction");
  error(std::string(kFeet) + kPlates + ", sessions: {}", "either column, counts or from_encoders");
  error(std::string(kFeet) + kPlates + ", sessions: {column: a, from_encoders: true}",
        "either column, counts or from_encoders");
  error(std::string(kFeet) + kPlates + ", sessions: {from_encoders: 1}", "from_encoders");
  error(
      std::string(kFeet) + kPlates + ", sessions: {counts: {columns: [a], quantum: 0, modulo: 64}}",
      "quantum");
  ExpectInputError([] { CheckHasMarkers(ProjectOf(std::string(kFeet) + kPlates)); },
                   {"no markers"});
}

class ObservationTableInput : public testing::Test {
 protected:
  ObservationTables Read(const std::string& text, const std::string& contact = "",
                         const std::string& rest = "recording: {ignore: [note]}\n") {
    std::ofstream(file_) << text;
    return ReadObservationTables({file_}, ProjectOf(std::string(kFeet) + kPlates + contact, rest));
  }

  ScratchFolder folder_;
  std::filesystem::path file_ = folder_.path() / "t.csv";
  Project project_ = ProjectOf(std::string(kFeet) + kPlates);
};

TEST_F(ObservationTableInput, SaysWhatIsWrong) {
  const std::string fine = TableText(project_, 3);
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = fine;
    const std::size_t at = text.rfind(from);
    return text.replace(at, from.size(), to);
  };
  ExpectInputError([&] { Read(TableText(project_, 3, "leg_left_3_joint")); },
                   {"t.csv", "leg_left_3_joint", "is missing"});
  ExpectInputError([&] { Read(replaced(",a\n", ",nan,a\n")); }, {"t.csv:4: "});
  std::string nan = fine;
  nan.replace(nan.find('\n') + 1, nan.find(',', nan.find('\n')) - nan.find('\n') - 1, "nan");
  ExpectInputError([&] { Read(nan); }, {"t.csv:2: ", "'nan'"});
  std::string degrees = fine;
  degrees.replace(degrees.find('\n') + 1,
                  degrees.find(',', degrees.find('\n')) - degrees.find('\n') - 1, "45");
  ExpectInputError([&] { Read(degrees); }, {"t.csv:2: ", "degrees; radians were expected"});
  ExpectInputError([&] { Read(fine, "", ""); }, {"note", "recording.ignore"});
  ExpectInputError([&] { Read(fine, ", sessions: {column: start}"); }, {"'start'", "sessions"});
  ExpectInputError([&] { Read(fine, ", plate_column: note", ""); },
                   {"t.csv:2: ", "no plate 'a'; known: left"});
  ExpectInputError([&] { Read(replaced(",a\n", ",\n"), ", sessions: {column: note}"); },
                   {"t.csv:4: ", "'note'", "there is no session"});
  ExpectInputError([&] { Read(fine.substr(0, fine.find('\n') + 1)); }, {"no row"});
  ExpectInputError(
      [&] {
        Read(TableText(project_, 1) +
             TableText(project_, 1).substr(TableText(project_, 1).find('\n') + 1));
      },
      {"all the same"});
  // Near the zero posture the arms hang: the hands' x axes are level.
  std::ofstream(file_) << fine;
  ExpectInputError(
      [&] {
        ReadObservationTables({file_},
                              ProjectOf(std::string(kFeet) + "plates: [{name: left, link: " +
                                            "gripper_left_base_link, normal: [1, 0, 0]}]",
                                        "recording: {ignore: [note]}\n"));
      },
      {"no plate lies flat"});
}

TEST_F(ObservationTableInput, AMistypedSessionIsNamed) {
  std::string text = TableText(project_, 3);
  for (const char* name : {"monday", "monday", "mondy"}) {
    text.replace(text.find(",a\n") + 1, 1, name);
  }
  const std::vector<std::string> warnings = Read(text, ", sessions: {column: note}", "").warnings;
  const std::string expected =
      "one row alone is of session 'mondy' (contact.sessions.column); did you mean 'monday'?";
  EXPECT_NE(warnings.back().find(expected), std::string::npos) << warnings.back();
}

TEST_F(ObservationTableInput, RepeatedRowsAreNamed) {
  const auto repeated = [](const ObservationTables& tables) {  // others are of limits
    std::vector<std::string> found;
    for (const std::string& warning : tables.warnings) {
      if (warning.find("in every cell") != std::string::npos) found.push_back(warning);
    }
    return found;
  };
  const std::string text = TableText(project_, 6);
  const std::string rows = text.substr(text.find('\n') + 1);
  EXPECT_TRUE(repeated(Read(text)).empty());
  const std::string file = file_.string();
  const std::string counts =
      " counts as an independent measurement, which it is not: standard deviations come out too "
      "small";
  EXPECT_EQ(repeated(Read(text + rows)),
            std::vector<std::string>{file + ":8: this row and 5 more repeat rows above them in " +
                                     "every cell (this one " + file + ":2); each" + counts});
  EXPECT_EQ(repeated(Read(text + rows.substr(0, rows.find('\n') + 1))),
            std::vector<std::string>{file + ":8: this row repeats " + file +
                                     ":2 in every cell; it" + counts});
  // One cell is another one.
  std::string other = rows;
  for (std::size_t at = 0; (at = other.find(",a\n", at)) != std::string::npos; ++at) {
    other[at + 1] = 'b';
  }
  EXPECT_TRUE(repeated(Read(text + other)).empty());
  // Another file.
  const std::filesystem::path second = folder_.path() / "second.csv";
  std::ofstream(second) << text;
  std::ofstream(file_) << text;
  const auto both = repeated(ReadObservationTables(
      {file_, second}, ProjectOf(std::string(kFeet) + kPlates, "recording: {ignore: [note]}\n")));
  ASSERT_EQ(both.size(), 1u);
  EXPECT_EQ(both[0].find(second.string() + ":2: this row and 5 more repeat rows"), 0u) << both[0];
}

TEST_F(ObservationTableInput, APlateUpsideDownIsNamed) {
  // The sole of a foot is level whatever the posture; as a plate, it is upright or upside down.
  const auto contact = [](const char* normal) {
    return std::string(
               "feet: [{link: left_sole_link}], plates: [{name: p, link: right_sole_link, ") +
           "normal: [0, 0, " + normal + "]}]";
  };
  std::ofstream(file_) << TableText(project_, 3);
  const char* ignore = "recording: {ignore: [note]}\n";
  EXPECT_EQ(ReadObservationTables({file_}, ProjectOf(contact("1"), ignore)).observations.count(),
            3);
  ExpectInputError([&] { ReadObservationTables({file_}, ProjectOf(contact("-1"), ignore)); },
                   {"plate 'p' lies upside down in 3 of 3 postures"});
  std::string named = TableText(project_, 3);
  for (std::size_t at = 0; (at = named.find(",a\n", at)) != std::string::npos;) named[at + 1] = 'p';
  std::ofstream(file_) << named;
  const std::string column = ", plate_column: note";
  EXPECT_EQ(ReadObservationTables({file_}, ProjectOf(contact("1") + column)).observations.count(),
            3);
  ExpectInputError([&] { ReadObservationTables({file_}, ProjectOf(contact("-1") + column)); },
                   {"plate 'p' lies upside down in 3 of 3 touches"});
}

TEST_F(ObservationTableInput, SessionsAreToldByCountsOfEncoders) {
  std::string text = TableText(project_, 4, "", "count,other");
  std::string with;
  int row = 0;
  const char* counts[] = {"0.37,0", "-0.27,0", "0.38,0", "0.371,0.64"};
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    std::string line = text.substr(at, end - at);
    if (row > 0) line = line.substr(0, line.size() - 1) + counts[row - 1];
    with += line + "\n";
    at = end + 1;
    ++row;
  }
  std::ofstream(file_) << with;
  const ObservationTables tables = ReadObservationTables(
      {file_},
      ProjectOf("feet: [{link: left_sole_link}], plates: [{name: p, link: right_sole_link}],"
                " sessions: {counts: {columns: [count, other], quantum: 0.01, modulo: 64}}"));
  ASSERT_EQ(tables.observations.effects.size(), 2u);
  EXPECT_EQ(tables.observations.effects[0].name, "37/0");
  const auto session = [&](std::size_t i) { return tables.observations.all[i].effects; };
  EXPECT_EQ(session(1), std::vector<int>{0});  // -27 is 37 modulo 64
  EXPECT_EQ(session(2), std::vector<int>{1});
  EXPECT_EQ(session(3), std::vector<int>{0});  // a whole turn of the other
}

TEST_F(ObservationTableInput, SessionsAreProposedWhereEncodersTellThem) {
  std::string text;
  std::istringstream lines(TableText(project_, 24, "", "gripper"));
  std::string line;
  std::getline(lines, text);
  text += "\n";
  Random random(2);
  for (int row = 0; std::getline(lines, line); ++row) {
    const double step = 4e-5;
    const double homed = row < 10 ? 0.2 : 0.83;
    text += line.substr(0, line.size() - 1) + FormatNumber(step * (random.Index(4) + homed)) + "\n";
  }
  const char* const ignore = "recording: {ignore: [gripper]}\n";
  const auto proposals = [](const ObservationTables& tables) {  // others are of limits
    std::vector<std::string> found;
    for (const std::string& warning : tables.warnings) {
      if (warning.find("from_encoders") != std::string::npos) found.push_back(warning);
    }
    return found;
  };
  const ObservationTables proposed = Read(text, "", ignore);
  EXPECT_EQ(proposed.observations.effects.size(), 1u);
  ASSERT_EQ(proposals(proposed).size(), 1u);
  for (const char* part : {"t.csv", "2 starts", "gripper", "4e-05", "from_encoders: true"}) {
    EXPECT_NE(proposals(proposed)[0].find(part), std::string::npos) << proposals(proposed)[0];
  }
  const ObservationTables told = Read(text, ", sessions: {from_encoders: true}", ignore);
  ASSERT_EQ(told.observations.effects.size(), 2u);
  EXPECT_EQ(told.observations.all[9].effects, std::vector<int>{0});
  EXPECT_EQ(told.observations.all[10].effects, std::vector<int>{1});
  EXPECT_TRUE(proposals(Read(text, ", sessions: {from_encoders: false}", ignore)).empty());
}

TEST(ContactFile, IsReadAsItWasWritten) {
  const Project project = ProjectOf(std::string(kFeet) + kPlates);
  ObservedRobot model = MakeObservedRobot(project.tree, {}, project.contact->setup, {}, {});
  ObservationFit fit;
  fit.spread = FirstSpread(model.setup.sources);
  fit.values.quantities.push_back({Transform::Identity(), Eigen::Vector2d(0.1, 1.0 / 3.0)});
  fit.values.quantities.push_back(
      {Offset(0.6, 0.1, 0.7) * RotX(0.3), Eigen::Vector3d(1e-3, -0.01, 0.02)});
  ObservationFit other = fit;
  other.values.quantities[1].x[0] = 5.0;
  ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "calibration.yaml";
  std::ofstream(file) << MakeContactYaml(model, fit, other);
  const StoredContacts stored = ReadContacts(file, project);
  const auto& read = stored.calibrated.quantities;
  EXPECT_EQ(read.at("left.tilts").x, fit.values.quantities[0].x);
  EXPECT_EQ(read.at("left.plane").x, fit.values.quantities[1].x);
  EXPECT_TRUE(read.at("left.plane").origin.isApprox(fit.values.quantities[1].origin, 1e-15));
  EXPECT_EQ(stored.uncalibrated.quantities.at("left.plane").x[0], 5.0);
  EXPECT_EQ(stored.calibrated.spread.sd, fit.spread.sd);
  std::string text = MakeContactYaml(model, fit, other);
  std::ofstream(file) << text.replace(text.find("left.plane"), 10, "left.plaen");
  ExpectInputError([&] { ReadContacts(file, project); }, {"'left.plane' with 3 values"});
  std::ofstream(file) << "format: x\n";
  ExpectInputError([&] { ReadContacts(file, project); }, {"not made from touches"});
}

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

/// A table in which all instruments show something in the first row. `cells` replaces cells.
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
  EXPECT_EQ(tables.observations.effects.size(), 1u);  // of the wall
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
