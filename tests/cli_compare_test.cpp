// SPDX-License-Identifier: Apache-2.0
// The command `compare` as its users run it.

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "elastocal/files/output_files.hpp"
#include "tests/program_fixture.hpp"

namespace elastocal {
namespace {

TEST_F(Program, CompareNamesTheJointThatMoved) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  constexpr double kChange = 5e-3;
  const std::string later = CalibratedLater("later", "elbow_joint.theta", kChange);
  const std::string json_file = (scratch_.path() / "compare.json").string();
  const ProgramResult result =
      RunProgram("compare " + out_ + " " + later + "/calibration.yaml" + " --json " + json_file);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("Moved by more than their uncertainty: elbow_joint\n"),
            std::string::npos)
      << result.out;
  EXPECT_EQ(result.out.find("Moved by more"), 0u) << "the verdict comes first";
  EXPECT_NE(result.out.find("more: --verbose\n"), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("Not compared\n"), std::string::npos) << result.out;
  const ProgramResult all = RunProgram("compare --verbose " + out_ + " " + later);
  EXPECT_EQ(all.out.find("more: --verbose\n"), std::string::npos) << all.out;
  EXPECT_NE(all.out.find("Not compared\n"), std::string::npos) << all.out;
  EXPECT_LT(result.out.find("elbow_joint.theta"), result.out.find("shoulder_joint.theta"));
  const nlohmann::json json = nlohmann::json::parse(ReadFile(json_file));
  EXPECT_EQ(json["status"], "moved");
  EXPECT_EQ(json["moved"], nlohmann::json({"elbow_joint"}));
  EXPECT_EQ(json["with_covariance"], true);
  EXPECT_EQ(json["joints"][0]["joint"], "elbow_joint");
  EXPECT_TRUE(json["joints"][0]["or_markers"].empty());
  // The single marker on the wrist tells nothing. The others have not moved.
  ASSERT_EQ(json["markers"].size(), 3u);
  for (const nlohmann::json& link : json["markers"]) EXPECT_EQ(link["same"], true) << link;
  EXPECT_NE(result.out.find("Markers: on 3 of 3 links all are where they were"), std::string::npos);
  const ProgramResult anew =
      RunProgram("compare " + out_ + " " + later + " --new-markers --json " + json_file);
  EXPECT_TRUE(nlohmann::json::parse(ReadFile(json_file))["markers"].empty());
  EXPECT_EQ(anew.out.find("Markers:"), std::string::npos);
  const nlohmann::json& theta = json["parameters"][0];
  EXPECT_EQ(theta["name"], "elbow_joint.theta");
  EXPECT_EQ(theta["unit"], "rad");
  EXPECT_NEAR(theta["difference"].get<double>(), kChange, 4.0 * theta["sd"].get<double>());
  EXPECT_LT(theta["interval_95"][0], theta["difference"]);
  EXPECT_GT(theta["interval_95"][1], theta["difference"]);
  EXPECT_EQ(theta["significant"], true);
  EXPECT_FALSE(json["not_compared"].empty());
  // Of the joint's parameters, the one that changed is marked.
  const std::size_t mark = result.out.find("* moved");
  ASSERT_NE(mark, std::string::npos);
  EXPECT_EQ(result.out.find(" moved", mark + 7), std::string::npos) << result.out;
}

TEST_F(Program, CompareWithoutCovarianceOrChange) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const std::string later = CalibratedLater("later", "elbow_joint.theta", 0.0);
  std::filesystem::remove(later + "/covariance.csv");
  const ProgramResult result = RunProgram("compare " + out_ + " " + later + " --json -");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("without covariance.csv of both"), std::string::npos) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["status"], "unchanged");
  EXPECT_EQ(json["with_covariance"], false);
  EXPECT_TRUE(json["joints"][0]["F"].is_null());
}

TEST_F(Program, CompareRefusesOtherRobotsAndFoldersWithoutResult) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const auto refused = [](const std::string& arguments, std::initializer_list<std::string> parts) {
    const ProgramResult result = RunProgram("compare " + arguments);
    EXPECT_EQ(result.exit_code, 3) << result.out;
    for (const std::string& part : parts) {
      EXPECT_NE(result.err.find(part), std::string::npos) << part << " not in " << result.err;
    }
  };
  std::string other = ReadFile(out_ + "/calibration.yaml");
  const std::size_t robot = other.find("robot: ") + 7;
  other.replace(robot, other.find('\n', robot) - robot, "stranger");
  const std::size_t nominal = other.find("nominal: \"") + 10;
  other[nominal] = other[nominal] == '0' ? '1' : '0';
  refused(out_ + " " + scratch_.Write("other.yaml", other), {"'arm6'", "'stranger'"});
  refused(out_ + " " + scratch_.path().string(), {"no calibration.yaml"});
  refused(out_ + " no_such.yaml", {"no_such.yaml"});
  refused(out_ + " " + out_ + " --json " + out_ + "/covariance.csv", {"input"});
  const std::string later = CalibratedLater("later", "elbow_joint.theta", 0.0);
  std::filesystem::copy_file(out_ + "/covariance.csv", later + "/covariance.csv",
                             std::filesystem::copy_options::overwrite_existing);
  refused(out_ + " " + later, {"covariance.csv", "of two runs"});
  std::filesystem::remove(later + "/SHA256SUMS");
  refused(out_ + " " + later, {"covariance.csv:2", "another calibration"});
}

// Each file of a recording folder is an input.
TEST_F(Program, NoCommandReplacesTheFilesOfARecording) {
  const Project project = ReadProject(SourceFile("tests/robots/mini_humanoid_project.yaml"));
  for (const char* name : {"a.tsv", "a.csv"}) scratch_.Write(name, "x\n");
  scratch_.Write("experiment.yaml",
                 "trials: [{name: a, chain: head, markers: a.tsv, joints: a.csv}]");
  const std::string what = project.file.string() + " --recording " + scratch_.path().string();
  for (const char* name : {"a.tsv", "a.csv", "experiment.yaml"}) {
    const std::string input = (scratch_.path() / name).string();
    const std::string before = ReadFile(input);
    ExpectRefused(RunProgram("calibrate " + what + " -o " + out_ + " --json " + input),
                  {name, "this is an input"});
    ExpectRefused(RunProgram("validate " + what + " --calibration c.yaml --json " + input),
                  {name, "this is an input"});
    EXPECT_EQ(ReadFile(input), before);
  }
}

TEST_F(Program, CompareAndInspectReplaceNoInput) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  for (const char* name : {"calibration.yaml", "covariance.csv"}) {
    const std::string input = out_ + "/" + name;
    const std::string before = ReadFile(input);
    const ProgramResult result =
        RunProgram("compare " + out_ + " " + out_ + " --json " + out_ + "/../out/" + name);
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_NE(result.err.find("this is an input"), std::string::npos) << result.err;
    EXPECT_EQ(ReadFile(input), before);
  }
  const std::string urdf =
      scratch_.Write("arm6.urdf", ReadFile(SourceFile("tests/robots/arm6.urdf")));
  const std::string project = scratch_.Write("arm6_project.yaml", ReadFile(project_));
  EXPECT_EQ(RunProgram("inspect " + project + " --json " + urdf).exit_code, 3);
  EXPECT_EQ(ReadFile(urdf), ReadFile(SourceFile("tests/robots/arm6.urdf")));
}

}  // namespace
}  // namespace elastocal
