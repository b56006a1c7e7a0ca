// SPDX-License-Identifier: Apache-2.0
// What `export` writes for single robots, without the program.
#include <algorithm>
#include <filesystem>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "elastocal/exports/export_calibration.hpp"
#include "elastocal/exports/runtime_robot.hpp"
#include "elastocal/files/output_files.hpp"
#include "elastocal/files/yaml_value.hpp"
#include "elastocal/pipeline/result_folder.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/runtime_calibration.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

class Exports : public testing::Test {
 protected:
  /// The robot with a calibration that is read from a file; `more` is added to that file.
  CalibratedRobot Robot(const Project& project, const StoredCalibration& stored,
                        const std::string& more = "") const {
    CalibrationEstimate estimate;
    estimate.robot = stored.robot;
    estimate.nominal = stored.nominal;
    estimate.recording = "drawn";
    estimate.model = "full";
    for (const Parameter& parameter : RestoreRobot(project, stored).model.parameters) {
      const auto error = stored.joint_errors.find(parameter.name);
      if (error == stored.joint_errors.end()) continue;
      estimate.parameters.push_back({.name = parameter.name,
                                     .unit = UnitName(parameter.unit),
                                     .value = error->second,
                                     .sd = 1e-3});
    }
    const auto file = scratch_.Write("calibration.yaml", MakeCalibrationYaml(estimate) + more);
    return {project, ReadCalibration(file), {}};
  }

  ScratchFolder scratch_;
  Project talos_ = ReadProject(SourceFile("models/talos/project.yaml"));
};

TEST_F(Exports, RodsAreThoseOfTheGeometryInTheUrdf) {
  const Project project = ReadProject(SourceFile("tests/robots/linked_biped_project.yaml"));
  StoredCalibration stored = RandomCalibration(project, 1);
  const Rod& rod = project.tree.linkages.front().rods.front();
  stored.joint_errors.at(rod.motor + ".length") = 1e-3;
  const CalibratedRobot robot =
      Robot(project, stored,
            "urdf:\n  model: geometric\n  errors:\n    " + rod.motor + ".length: 0.004\n");
  const auto length_mm = [&](bool beside_springs) {
    const std::string text =
        ExportCalibration(robot, {.format = "linkages", .beside_springs = beside_springs}).text;
    const YamlValue yaml = YamlValue::Parse(text, "linkages");
    return yaml.Get("linkages").Items()[0].Get("rods").Items()[0].Get("length_mm").Number();
  };
  EXPECT_NEAR(length_mm(false) - 1e3 * rod.length, 4.0, 1e-9);
  EXPECT_NEAR(length_mm(true) - 1e3 * rod.length, 1.0, 1e-9);
}

TEST_F(Exports, NamesInCAreNoneOfTheHeadersOwn) {
  const CalibratedRobot robot = Robot(talos_, RandomCalibration(talos_, 1));
  for (const char* prefix : {"ec", "EC", "ec_arm"}) {
    ExpectInputError([&] { ExportCalibration(robot, {.format = "c99", .prefix = prefix}); },
                     {prefix, "'ec_'"});
  }
  EXPECT_FALSE(ExportCalibration(robot, {.format = "c99", .prefix = "echo"}).text.empty());
  talos_.tree.name = "EC";
  const CalibratedRobot renamed = Robot(talos_, RandomCalibration(talos_, 1));
  EXPECT_NE(ExportCalibration(renamed, {.format = "c99"}).text.find("robot_ec_state"),
            std::string::npos);
}

TEST_F(Exports, SayThatNothingGivesWay) {
  StoredCalibration stored = RandomCalibration(talos_, 1);
  const auto notes = [&] {
    const ExportedCalibration exported =
        ExportCalibration(Robot(talos_, stored), {.format = "runtime"});
    return std::ranges::count_if(exported.notes, [](const std::string& note) {
      return note.starts_with("Nothing gives way");
    });
  };
  EXPECT_EQ(notes(), 0);
  for (auto& [name, value] : stored.joint_errors) {
    if (name.find(".compliance") != std::string::npos) value = 0.0;
  }
  EXPECT_EQ(notes(), 1);
  const CalibratedRobot robot = Robot(talos_, stored);
  ExpectInputError([&] { ExportCalibration(robot, {.beside_springs = true}); },
                   {"--beside-springs", "no springs"});
  ExpectInputError(
      [&] {
        ExportCalibration(robot, {.format = "mjcf", .mjcf = "robot.xml", .mjcf_springs = true});
      },
      {"--mjcf-springs", "no springs"});
}

TEST_F(Exports, UrdfsFindTheirMeshesFromAnotherFolder) {
  std::string urdf = ReadFile(talos_.urdf);
  const std::string mesh = R"(<mesh filename='meshes/a &amp; b&apos;s.stl'/>)";
  const std::string visual = "<visual><geometry>" + mesh + "</geometry></visual>";
  urdf.insert(urdf.find('>', urdf.find("<link")) + 1, visual);
  ASSERT_EQ(urdf.find("/>" + visual), std::string::npos);
  std::filesystem::create_directories(scratch_.path() / "robot");
  std::filesystem::create_directories(scratch_.path() / "out");
  talos_.urdf = scratch_.Write("robot/talos.urdf", urdf);
  const CalibratedRobot robot = Robot(talos_, RandomCalibration(talos_, 1));
  const std::string moved = R"(filename='../robot/meshes/a &#38; b&#39;s.stl')";
  for (const char* format : {"urdf", "urdf_encoder", "urdf_rising"}) {
    const auto written = [&](const std::string& file) {
      return ExportCalibration(robot, {.format = format, .output = scratch_.path() / file}).text;
    };
    EXPECT_NE(written("robot/c.urdf").find(mesh), std::string::npos) << format;
    EXPECT_NE(written("out/c.urdf").find(moved), std::string::npos) << format;
  }
  // The same for the file that `calibrate` writes.
  const std::filesystem::path folder = scratch_.path() / "out";
  OutputSet outputs;
  DeclareResults(folder, {"talos_calibrated.urdf"}, outputs);
  outputs.Prepare();
  RunRecord record{.command = "calibrate",
                   .command_line = "",
                   .version = "1",
                   .seed = {},
                   .inputs = RecordInputs({talos_.urdf})};
  SetResults(folder, {{"talos_calibrated.urdf", urdf}}, record, outputs);
  outputs.Publish();
  EXPECT_NE(ReadFile(folder / "talos_calibrated.urdf").find(moved), std::string::npos);
}

}  // namespace
}  // namespace elastocal
