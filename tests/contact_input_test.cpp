#include <fstream>
#include <functional>

#include <gtest/gtest.h>

#include "elastocal/io/contact_file.hpp"
#include "elastocal/io/touch_table.hpp"
#include "elastocal/math/random.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

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
  error(kPlates, "feet");
  error("feet: [{link: left_sole_lnk}], " + std::string(kPlates), "did you mean 'left_sole_link'?");
  error("feet: [{link: base_link}], " + std::string(kPlates), "a foot was expected");
  error("feet: [{link: left_sole_link, position_mm: [0, 1, 0]}], " + std::string(kPlates),
        "[0, 0, 0]");
  error(std::string(kFeet) + "plates: [{name: a, link: gripper_left_base_link, normal: [0, 0, 0]}]",
        "a direction");
  error(std::string(kFeet) + kPlates + ", sessions: {}", "either column or counts");
  error(
      std::string(kFeet) + kPlates + ", sessions: {counts: {columns: [a], quantum: 0, modulo: 64}}",
      "quantum");
  error(std::string(kFeet) + kPlates, "not possible yet",
        "markers: {single: [{name: A, link: arm_left_7_link, position_mm: [0, 0, 9]}]}\n");
  ExpectInputError([] { CheckHasMarkers(ProjectOf(std::string(kFeet) + kPlates)); },
                   {"no markers"});
}

class TouchTableInput : public testing::Test {
 protected:
  TouchTables Read(const std::string& text, const std::string& contact = "",
                   const std::string& rest = "recording: {ignore: [note]}\n") {
    std::ofstream(file_) << text;
    return ReadTouchTables({file_}, ProjectOf(std::string(kFeet) + kPlates + contact, rest));
  }

  ScratchFolder folder_;
  std::filesystem::path file_ = folder_.path() / "t.csv";
  Project project_ = ProjectOf(std::string(kFeet) + kPlates);
};

TEST_F(TouchTableInput, SaysWhatIsWrong) {
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
  ExpectInputError([&] { Read(fine, ", plate_column: note", ""); }, {"t.csv:2: ", "no plate 'a'"});
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
        ReadTouchTables({file_}, ProjectOf(std::string(kFeet) + "plates: [{name: left, link: " +
                                               "gripper_left_base_link, normal: [1, 0, 0]}]",
                                           "recording: {ignore: [note]}\n"));
      },
      {"no plate lies flat"});
}

TEST_F(TouchTableInput, APlateUpsideDownIsNamed) {
  // The sole of a foot is level whatever the posture; as a plate, it is upright or upside down.
  const auto contact = [](const char* normal) {
    return std::string(
               "feet: [{link: left_sole_link}], plates: [{name: p, link: right_sole_link, ") +
           "normal: [0, 0, " + normal + "]}]";
  };
  std::ofstream(file_) << TableText(project_, 3);
  const char* ignore = "recording: {ignore: [note]}\n";
  EXPECT_EQ(ReadTouchTables({file_}, ProjectOf(contact("1"), ignore)).touches.count(), 3);
  ExpectInputError([&] { ReadTouchTables({file_}, ProjectOf(contact("-1"), ignore)); },
                   {"upside down"});
}

TEST_F(TouchTableInput, SessionsAreToldByCountsOfEncoders) {
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
  const TouchTables tables = ReadTouchTables(
      {file_},
      ProjectOf("feet: [{link: left_sole_link}], plates: [{name: p, link: right_sole_link}],"
                " sessions: {counts: {columns: [count, other], quantum: 0.01, modulo: 64}}"));
  ASSERT_EQ(tables.touches.sessions.size(), 2u);
  EXPECT_EQ(tables.touches.sessions[0].name, "37/0");
  EXPECT_EQ(tables.touches.touches[1].session, 0);  // -27 is 37 modulo 64
  EXPECT_EQ(tables.touches.touches[2].session, 1);
  EXPECT_EQ(tables.touches.touches[3].session, 0);  // a whole turn of the other
}

TEST(ContactFile, IsReadAsItWasWritten) {
  const Project project = ProjectOf(std::string(kFeet) + kPlates);
  ContactModel model = MakeContactModel(project.tree, {}, project.contact->setup, {}, {});
  ContactFit fit;
  fit.values.plate_tilts = {Eigen::Vector2d(0.1, 1.0 / 3.0)};
  fit.values.tables = {{Eigen::Vector3d(0.6, 0.1, 0.7), Eigen::Vector3d(1e-3, -0.01, 0.02)}};
  ContactFit other = fit;
  other.values.tables[0].height_tilts[0] = 5.0;
  ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "calibration.yaml";
  std::ofstream(file) << MakeContactYaml(model, fit, other);
  const StoredContacts stored = ReadContacts(file, project);
  EXPECT_EQ(stored.calibrated.plate_tilts[0], fit.values.plate_tilts[0]);
  EXPECT_EQ(stored.calibrated.tables[0].height_tilts, fit.values.tables[0].height_tilts);
  EXPECT_EQ(stored.uncalibrated.tables[0].height_tilts[0], 5.0);
  EXPECT_EQ(stored.calibrated.spread.sd, fit.spread.sd);
  std::ofstream(file) << "format: x\n";
  ExpectInputError([&] { ReadContacts(file, project); }, {"not made from touches"});
}

}  // namespace
}  // namespace elastocal
