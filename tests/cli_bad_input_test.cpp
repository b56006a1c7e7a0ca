// SPDX-License-Identifier: Apache-2.0
// Bad input is refused with exit code 3 and the place of the error, and nothing is written.

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "elastocal/files/output_files.hpp"
#include "tests/program_fixture.hpp"

namespace elastocal {
namespace {

TEST_F(Program, MissingFilesAreNamed) {
  ExpectRefused(Calibrate("no_such.yaml", recording_), {"no_such.yaml"});
  ExpectRefused(Calibrate(project_, "no_such.csv"), {"no_such.csv"});
  ExpectRefused(
      RunProgram("validate " + project_ + " --calibration no.yaml --recording " + recording_),
      {"no.yaml"});
}

TEST_F(Program, MalformedProjectAndUrdfAreNamedByLine) {
  ExpectRefused(Calibrate(scratch_.Write("bad.yaml", "robot: {urdf: [\n"), recording_),
                {"bad.yaml:"});
  scratch_.Write("bad.urdf", "<robot name='r'>\n<link name='a'>\n</robot>\n");
  ExpectRefused(Calibrate(scratch_.Write("p.yaml",
                                         "robot: {urdf: bad.urdf}\n"
                                         "markers: {single: [{name: M, link: a, position_mm: "
                                         "[0, 0, 0]}]}\n"),
                          recording_),
                {"bad.urdf:"});
}

TEST_F(Program, ConvertDoesNotPromiseAFormatThatItDoesNotWrite) {
  const std::string log = scratch_.Write("log.csv", "t,elbow_joint\n0,0.1\n0.01,0.2\n0.02,0.3\n");
  const std::string output = (scratch_.path() / "out.c3d").string();
  ExpectRefused(RunProgram("convert " + log + " -o " + output), {"out.c3d", ".tsv"});
  EXPECT_FALSE(std::filesystem::exists(output));
  const std::string written = (scratch_.path() / "out.csv").string();
  EXPECT_EQ(RunProgram("convert " + log + " -o " + written).exit_code, 0);
  EXPECT_EQ(RunProgram("info " + written).exit_code, 0);
}

TEST_F(Program, ConvertReplacesOnlyWhatItWrote) {
  const std::string theirs = "t,elbow_joint\n0.00,0.1\n0.01,0.2\n0.02,0.3\n";
  const std::string log = scratch_.Write("log.csv", theirs);
  const std::string other = scratch_.Write("other.csv", theirs);
  ExpectRefused(RunProgram("convert " + log + " -o " + other),
                {"other.csv: is there and was not written by this command"});
  EXPECT_EQ(ReadFile(other), theirs);
  const std::string written = (scratch_.path() / "out.csv").string();
  for (int run = 0; run < 2; ++run) {
    EXPECT_EQ(RunProgram("convert " + log + " -o " + written).exit_code, 0);
  }
  const std::string camera =
      "FREQUENCY\t100\nMARKER_NAMES\tA\nFrame\tTime\tA X\tA Y\tA Z\n1\t0\t1\t2\t3\n";
  const std::string markers = scratch_.Write("camera.tsv", camera);
  const std::string another = scratch_.Write("another.tsv", camera);
  ExpectRefused(RunProgram("convert " + markers + " -o " + another), {"another.tsv: is there"});
  EXPECT_EQ(ReadFile(another), camera);
  for (int run = 0; run < 2; ++run) {
    const ProgramResult again =
        RunProgram("convert " + markers + " -o " + (scratch_.path() / "turned.tsv").string());
    EXPECT_EQ(again.exit_code, 0) << again.err;
  }
}

// JSON must be UTF-8. A name that is not is refused before the fit.
TEST_F(Program, NamesThatAreNotUtf8AreRefused) {
  std::string project = ReadFile(project_);
  const std::string urdf = SourceFile("tests/robots/arm6.urdf").string();
  project.replace(project.find("arm6.urdf"), 9, urdf);
  project.replace(project.find("name: WRIST"), 11, "name: caf\xe9");
  project.insert(project.find("not_recorded_mm"),
                 "columns: {markers: {caf\xe9: [WRIST_x, WRIST_y, WRIST_z]}}\n  ");
  ExpectRefused(Calibrate(scratch_.Write("p.yaml", project), recording_), {"p.yaml:15: ", "UTF-8"});
  ExpectRefused(Calibrate(project_, WithCell(0, 2, "caf\xe9")), {"changed.csv:1: ", "UTF-8"});
}

TEST_F(Program, UnknownKeyJointAndMarkerComeWithTheNearestKnownName) {
  const std::string urdf = SourceFile("tests/robots/arm6.urdf").string();
  const std::string begin = "robot: {urdf: " + urdf + "}\n";
  const std::string marker = "markers: {single: [{name: M, link: tool, position_mm: [9, 9, 9]}]}\n";
  ExpectRefused(Calibrate(scratch_.Write("p.yaml", begin + marker + "recordin: {}\n"), recording_),
                {"p.yaml:3", "recordin", "did you mean 'recording'"});
  ExpectRefused(Calibrate(scratch_.Write("p.yaml", begin + marker +
                                                       "recording: {columns: {joints: {elbow_joit: "
                                                       "a}}}\n"),
                          recording_),
                {"p.yaml:3", "elbow_joit", "did you mean 'elbow_joint'"});
  ExpectRefused(Calibrate(scratch_.Write("p.yaml", begin + marker +
                                                       "recording: {columns: {markers: {N: "
                                                       "[a, b, c]}}}\n"),
                          recording_),
                {"p.yaml:3", "'N'"});
}

// Nothing is planned for robots that cannot stand: planning takes minutes.
TEST_F(Program, RobotsOnNoSolesAreRefusedBeforeTheMotionIsPlanned) {
  const ProgramResult result = RunProgram("plan " + project_ + " --kind random --robots 1 -o " +
                                          (scratch_.path() / "motion.csv").string());
  ExpectRefused(result, {"without a number of robots", "no section 'standing'"});
  EXPECT_EQ(result.out, "");
}

TEST_F(Program, BadCellsAreNamedByLineAndColumn) {
  ExpectRefused(Calibrate(project_, WithCell(5, 2, "oops")), {"changed.csv:6", "oops"});
  ExpectRefused(Calibrate(project_, WithCell(5, 2, "nan")), {"changed.csv:6", "nan"});
  ExpectRefused(Calibrate(project_, WithCell(0, 2, "no_such_column")),
                {"changed.csv", "no_such_column"});
}

TEST_F(Program, TooFewOrNoPosturesAreRefused) {
  std::ifstream stream(recording_);
  std::string header, row;
  std::getline(stream, header);
  ExpectRefused(Calibrate(project_, scratch_.Write("empty.csv", header + "\n")), {"empty.csv"});
  std::getline(stream, row);
  ExpectRefused(Calibrate(project_, scratch_.Write("few.csv", header + "\n" + row + "\n")),
                {"few.csv", "equations", "parameters"});
}

TEST_F(Program, BadTablesAreRefusedWhole) {
  const std::string good = ReadFile(recording_);
  ExpectRefused(Calibrate(project_, scratch_.Write("zeros.csv", std::string(200 << 20, '0'))),
                {"zeros.csv:1"});
  const auto scaled = [&](const std::string& marker, double factor) {
    const Project project = ReadProject(project_);
    Recording recording = ReadPostureTable(recording_, project).recording;
    for (int m = 0; m < recording.marker_count(); ++m) {
      if (!recording.marker_names[m].starts_with(marker)) continue;
      recording.markers.middleCols(3 * m, 3) *= factor;
    }
    WritePostureTable(scratch_.path() / "scaled.csv", recording, project.tree);
    return (scratch_.path() / "scaled.csv").string();
  };
  ExpectRefused(Calibrate(project_, scaled("", 1000.0)), {"scaled.csv", "1000 times too large"});
  ExpectRefused(Calibrate(project_, scaled("WRIST", 1000.0)), {"scaled.csv", "WRIST"});
  const Project project = ReadProject(project_);
  Recording twins = ReadPostureTable(recording_, project).recording;
  twins.markers.middleCols(3, 3) = twins.markers.leftCols(3);
  WritePostureTable(scratch_.path() / "twins.csv", twins, project.tree);
  ExpectRefused(Calibrate(project_, (scratch_.path() / "twins.csv").string()),
                {"twins.csv", twins.marker_names[0], twins.marker_names[1]});
  std::string missing = good;
  missing.replace(missing.find("elbow_joint"), 11, "elbow_angle");
  ExpectRefused(Calibrate(project_, scratch_.Write("missing.csv", missing)),
                {"missing.csv", "elbow_angle"});
}

}  // namespace
}  // namespace elastocal
