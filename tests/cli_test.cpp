// SPDX-License-Identifier: Apache-2.0
// The program as its users run it: usage, and commands with few tests of their own.

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "elastocal/files/output_files.hpp"
#include "tests/program_fixture.hpp"

namespace elastocal {
namespace {

TEST_F(Program, HelpHasAnExampleForEveryCommand) {
  EXPECT_EQ(RunProgram("--help").exit_code, 0);
  for (const char* command :
       {"init", "inspect", "design", "assess", "plan", "simulate", "calibrate", "validate", "check",
        "compare", "batch", "report", "demo"}) {
    const ProgramResult help = RunProgram(std::string(command) + " --help");
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_NE(help.out.find("Example: elastocal " + std::string(command)), std::string::npos);
    for (const char* option : {"--json", "--quiet"}) {
      EXPECT_NE(help.out.find(option), std::string::npos) << command << option;
    }
    const std::string name = command;
    const bool draws = name != "compare" && name != "batch" && name != "report" && name != "init";
    EXPECT_EQ(help.out.find("--seed") != std::string::npos, draws) << command;
  }
}

TEST_F(Program, AnOutputWithoutNameIsWrongUsage) {
  for (const std::string command :
       {"design p.yaml", "plan p.yaml --kind sine", "simulate p.yaml", "report here", "demo",
        "calibrate p.yaml --recording r", "validate p.yaml --calibration c --recording r"}) {
    const ProgramResult result = RunProgram(command + " -o ''");
    EXPECT_EQ(result.exit_code, 2) << command;
    EXPECT_NE(result.err.find("the output needs a name"), std::string::npos) << result.err;
  }
}

// All these are refused before the project is read, which does not exist.
TEST_F(Program, NumbersHaveTheirRangesAndListsTheirWordsInAnyCase) {
  for (const std::string wrong :
       {"--move-s 0.05", "--rest-s 0.9", "--rest-s nan", "--zmp-margin-mm 1001",
        "--torque-share 0.001", "--velocity-share 1.1", "--floor-friction 11",
        "--leg-geometry-scale -1"}) {
    EXPECT_EQ(RunProgram("plan no.yaml --kind sine -o m.csv " + wrong).exit_code, 2) << wrong;
  }
  EXPECT_EQ(RunProgram("assess no.yaml --postures p.yaml --marker-noise-mm nan").exit_code, 2);
  EXPECT_EQ(RunProgram("design no.yaml -o p.yaml --criterion o6").exit_code, 2);
  EXPECT_EQ(RunProgram("design no.yaml -o p.yaml --criterion o2").exit_code, 3);
  EXPECT_EQ(RunProgram("plan no.yaml -o m.csv --kind Sine").exit_code, 3);
  const auto inspected = [&](const std::string& external) {
    return RunProgram("inspect " + project_ + " --external " + external).out;
  };
  EXPECT_EQ(inspected("LAST"), inspected("last"));
  EXPECT_NE(inspected("LAST"), inspected("first"));
  EXPECT_EQ(RunProgram("plan no.yaml -o m.csv --kind sine --postures p.yaml").exit_code, 2);
}

// The messages name the option, what was found, and what was expected.
TEST_F(Program, WrongUsageIsSaidInTheProgramsOwnWords) {
  const std::string plan = "plan no.yaml --kind sine -o m.csv ";
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {plan + "--seed abc", "--seed: found 'abc'; expected a whole number from 0 on"},
      {plan + "--seed 1e30", "--seed: found '1e30'; expected a whole number"},
      {plan + "--robots 1.5", "--robots: found '1.5'; expected a whole number from 0 to 1000"},
      {plan + "--robots", "--robots: found nothing; expected a value"},
      {plan + "-o n.csv", "--output: found several values; expected one"},
      {plan + "--lift 3", "not expected: '--lift', '3'; did you mean '--lift-mm'?"},
      {plan + "--postures p.yaml", "--postures and --kind cannot be given together"},
      {plan + "--floor-friction 0.5", "--floor-friction requires --robots"},
      {plan + "--no-stabiliser", "--no-stabiliser requires --robots"},
      {"plan no.yaml -o m.csv --kind sin",
       "--kind: found 'sin'; expected sine, random or repeatability; did you mean 'sine'?"},
      {"export out --format urdf -o f --min-gain -5",
       "--min-gain: found '-5'; expected a number from 0 to 100"},
      {"calibrate p.yaml --recordings x -o out",
       "--recording is required. The following arguments were not expected: '--recordings', 'x'; "
       "did you mean '--recording'?"},
      {"", "A command is required\nelastocal --help explains what there is."},
      {"calibrate", "elastocal calibrate --help explains the options."}};
  for (const auto& [words, message] : wrong) {
    const ProgramResult result = RunProgram(words);
    EXPECT_EQ(result.exit_code, 2) << words;
    EXPECT_NE(result.err.find(message), std::string::npos) << words << ": " << result.err;
    EXPECT_TRUE(result.err.starts_with("elastocal: error: ")) << words << ": " << result.err;
  }
}

TEST_F(Program, PlanRefusesTheApproachOfTouchesWhereThereAreNone) {
  const ProgramResult result =
      RunProgram("plan " + SourceFile("models/talos/project.yaml").string() +
                 " --postures p.yaml --approach-mm 40 -o " + out_ + "/m.csv");
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_NE(result.err.find("--approach-mm"), std::string::npos) << result.err;
}

TEST_F(Program, DesignRefusesWhatItsKindOfSearchDoesNotKnow) {
  EXPECT_EQ(RunProgram("design p.yaml -o q.yaml --after out --plateau 0.01").exit_code, 2);
  const std::string touches = SourceFile("examples/talos_touch/project.yaml").string();
  for (const std::string idle : {"--chains arm_left", "--elastic", "--block 2"}) {
    const ProgramResult result = RunProgram("design " + touches + " -o " + out_ + " " + idle);
    EXPECT_EQ(result.exit_code, 3) << idle;
    EXPECT_NE(result.err.find("error: " + idle.substr(0, idle.find(' '))), std::string::npos)
        << result.err;
  }
}

TEST_F(Program, WrongUsageEndsWithTwo) {
  EXPECT_EQ(RunProgram("").exit_code, 2);
  EXPECT_EQ(RunProgram("calibrat").exit_code, 2);
  EXPECT_NE(RunProgram("calibrat").err.find("did you mean 'calibrate'"), std::string::npos);
  EXPECT_EQ(RunProgram("demo --seed -1").exit_code, 2);
  EXPECT_EQ(RunProgram("calibrate " + project_).exit_code, 2);
  EXPECT_EQ(Calibrate(project_, recording_, "--kfold one").exit_code, 2);
  EXPECT_EQ(Calibrate(project_, recording_, "--no-such-option").exit_code, 2);
}

TEST_F(Program, QuietPrintsNothing) {
  const ProgramResult result = Calibrate(project_, recording_, "--quiet");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err.find("error"), std::string::npos) << result.err;
  EXPECT_EQ(nlohmann::json::parse(ReadFile(out_ + "/summary.json"))["kfold"]["folds"], 10);
}

TEST_F(Program, ValidateAppliesACalibrationToAnotherRecording) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  ErrorModel elsewhere = model_;
  elsewhere.T_ref_waist = Transform(Eigen::Translation3d(0.3, 0.2, -0.1)) * RotY(1.0);
  WritePostureTable(scratch_.path() / "other.csv",
                    MakeSyntheticRecording(elsewhere, truth_, {.postures = 25, .seed = 9}),
                    arm_.tree);
  const std::string json_file = (scratch_.path() / "validate.json").string();
  const ProgramResult result =
      RunProgram("validate " + project_ + " --calibration " + out_ + " --recording " +
                 (scratch_.path() / "other.csv").string() + " --json " + json_file);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json json = nlohmann::json::parse(ReadFile(json_file));
  EXPECT_LT(json["rmse_3d_mm"]["calibrated"], 0.4);
  EXPECT_GT(json["rmse_3d_mm"]["uncalibrated"], 3.0);
}

TEST_F(Program, CalibrationOfAnotherRobotIsRefused) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  std::string project = ReadFile(project_);
  project.replace(project.find("arm6.urdf"), 9, "arm6_calibrated.urdf");
  std::ofstream(out_ + "/project.yaml") << project;
  const ProgramResult result = RunProgram("validate " + out_ + "/project.yaml --calibration " +
                                          out_ + "/calibration.yaml --recording " + recording_);
  EXPECT_EQ(result.exit_code, 3) << result.out;
  EXPECT_NE(result.err.find("not the calibrated one"), std::string::npos) << result.err;
}

TEST_F(Program, InspectShowsCountsThatAgreeWithTheTheory) {
  const std::string json_file = (scratch_.path() / "inspect.json").string();
  const ProgramResult result = RunProgram(
      "inspect " + SourceFile("models/talos/project.yaml").string() + " --json " + json_file);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("torso_2_joint / head_1_joint"), std::string::npos);
  std::map<std::string, int> identifiable;
  const nlohmann::json json = nlohmann::json::parse(ReadFile(json_file));
  for (const auto& chain : json["chains"]) {
    EXPECT_EQ(chain["identifiable"], chain["identifiable_theory"]) << chain["chain"];
    identifiable[chain["chain"]] = chain["identifiable"];
  }
  EXPECT_EQ(identifiable["leg_left"], 51);
  EXPECT_EQ(identifiable["head_trunk"], 34);
  EXPECT_EQ(identifiable["arm_left"], 82);
}

TEST_F(Program, DemoFindsTheTruth) {
  const ProgramResult result = RunProgram("demo --quick --count 25 -o " + out_);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json summary = nlohmann::json::parse(ReadFile(out_ + "/summary.json"));
  EXPECT_GT(summary["rmse_3d_mm"]["uncalibrated"], 3.0);
  EXPECT_LT(summary["kfold"]["rmse_3d_mm"]["geometric"], 0.4);
  int inside = 0;
  int count = 0;
  const std::size_t at = result.out.find("joint parameters lie within");
  ASSERT_NE(at, std::string::npos) << result.out;
  const std::size_t line = result.out.rfind('\n', at) + 1;
  ASSERT_EQ(std::sscanf(result.out.c_str() + line, " %d of %d", &inside, &count), 2);
  EXPECT_GT(count, 50);
  EXPECT_GE(inside, 0.85 * count);  // 95 %, less the scatter of one robot with correlated errors
  EXPECT_TRUE(std::filesystem::exists(out_ + "/talos_calibrated.urdf"));
}

}  // namespace
}  // namespace elastocal
