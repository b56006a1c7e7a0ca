// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "elastocal/io/contact_file.hpp"
#include "elastocal/io/observation_table.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/tables/text.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/posture_text.hpp"
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
  // Near the zero posture the arms hang, so that the hands' x axes are level.
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
  const auto repeated = [](const ObservationTables& tables) {  // without warnings of limits
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
  // The rows differ in one cell.
  std::string other = rows;
  for (std::size_t at = 0; (at = other.find(",a\n", at)) != std::string::npos; ++at) {
    other[at + 1] = 'b';
  }
  EXPECT_TRUE(repeated(Read(text + other)).empty());
  // The rows are in another file.
  const std::filesystem::path second = folder_.path() / "second.csv";
  std::ofstream(second) << text;
  std::ofstream(file_) << text;
  const auto both = repeated(ReadObservationTables(
      {file_, second}, ProjectOf(std::string(kFeet) + kPlates, "recording: {ignore: [note]}\n")));
  ASSERT_EQ(both.size(), 1u);
  EXPECT_EQ(both[0].find(second.string() + ":2: this row and 5 more repeat rows"), 0u) << both[0];
}

TEST_F(ObservationTableInput, APlateUpsideDownIsNamed) {
  // The sole is level in any posture. As a plate, it is upright or upside down.
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
  EXPECT_EQ(session(3), std::vector<int>{0});  // a whole turn in the other column
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
  const auto proposals = [](const ObservationTables& tables) {  // without warnings of limits
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

}  // namespace
}  // namespace elastocal
