// The program as its users run it: commands, files, exit codes and messages.

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "elastocal/io/output_files.hpp"
#include "elastocal/io/posture_table.hpp"
#include "elastocal/io/project.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "tests/run_program.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

/// A small arm with a recording of it, to break in one place or another.
class Program : public ::testing::Test {
 protected:
  void SetUp() override {
    const Project project = ReadProject(SourceFile(kProject));
    const ErrorModel model = MakeErrorModel(project.tree, project.markers, project.placement);
    const BaseParameters base = FindBaseParameters(model, project.identifiability);
    truth_ = DrawErrors(model, base.kept, {{ParameterKind::kTheta, 0.01}}, 1);
    const Recording recording = MakeSyntheticRecording(model, truth_, {.postures = 30});
    WritePostureTable(scratch_.path() / "recording.csv", recording, project.tree);
    project_ = SourceFile(kProject).string();
    recording_ = (scratch_.path() / "recording.csv").string();
    out_ = (scratch_.path() / "out").string();
  }

  ProgramResult Calibrate(const std::string& project, const std::string& recording,
                          const std::string& more = "") {
    return RunProgram("calibrate " + project + " --recording " + recording + " -o " + out_ + " " +
                      more);
  }

  /// The recording with the cell of a row (0: header) and column replaced.
  std::string WithCell(int row, int column, const std::string& text) {
    std::ifstream stream(recording_);
    std::string line, changed;
    for (int r = 0; std::getline(stream, line); ++r) {
      if (r == row) {
        std::size_t begin = 0;
        for (int c = 0; c < column; ++c) begin = line.find(',', begin) + 1;
        line.replace(begin, line.find(',', begin) - begin, text);
      }
      changed += line + "\n";
    }
    return scratch_.Write("changed.csv", changed);
  }

  /// Bad input: exit code 3, all parts in the message, and no output at all.
  void ExpectRefused(const ProgramResult& result, std::initializer_list<std::string> parts) {
    EXPECT_EQ(result.exit_code, 3) << result.out << result.err;
    for (const std::string& part : parts) {
      EXPECT_NE(result.err.find(part), std::string::npos) << part << " not in: " << result.err;
    }
    EXPECT_FALSE(std::filesystem::exists(out_));
  }

  /// Another recording of the arm, its parameter changed, calibrated into `folder`.
  std::string CalibratedLater(const std::string& folder, const std::string& parameter,
                              double change) {
    const Project project = ReadProject(project_);
    const ErrorModel model = MakeErrorModel(project.tree, project.markers, project.placement);
    Eigen::VectorXd later = truth_;
    later[FindParameter(model.parameters, parameter)] += change;
    const std::string table = (scratch_.path() / (folder + ".csv")).string();
    WritePostureTable(table, MakeSyntheticRecording(model, later, {.postures = 25, .seed = 9}),
                      project.tree);
    const std::string out = (scratch_.path() / folder).string();
    const ProgramResult result =
        RunProgram("calibrate " + project_ + " --recording " + table + " -o " + out);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return out;
  }

  static constexpr const char* kProject = "tests/robots/arm6_project.yaml";
  ScratchFolder scratch_;
  Eigen::VectorXd truth_;
  std::string project_, recording_, out_;
};

TEST_F(Program, HelpHasAnExampleForEveryCommand) {
  EXPECT_EQ(RunProgram("--help").exit_code, 0);
  for (const char* command : {"inspect", "calibrate", "validate", "compare", "demo", "report"}) {
    const ProgramResult help = RunProgram(std::string(command) + " --help");
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_NE(help.out.find("Example: elastocal " + std::string(command)), std::string::npos);
    for (const char* option : {"--json", "--seed", "--quiet"}) {
      EXPECT_NE(help.out.find(option), std::string::npos) << command << option;
    }
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

TEST_F(Program, CalibrateWritesAllResults) {
  const std::string json_file = (scratch_.path() / "copy.json").string();
  const ProgramResult result = Calibrate(project_, recording_, "--kfold 5 --json " + json_file);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* file :
       {"arm6_calibrated.urdf", "calibration.yaml", "offsets.xacro", "summary.json"}) {
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(out_) / file)) << file;
  }
  const std::string text = ReadFile(std::filesystem::path(out_) / "summary.json");
  EXPECT_EQ(text, ReadFile(json_file));
  const nlohmann::json summary = nlohmann::json::parse(text);
  EXPECT_EQ(summary["status"], "converged");
  EXPECT_EQ(summary["postures"], 30);
  EXPECT_EQ(summary["kfold"]["folds"], 5);
  EXPECT_EQ(summary["identifiable"], summary["identifiable_theory"]);
  EXPECT_TRUE(summary["outliers"].empty());
  EXPECT_GT(summary["solve_seconds"], 0.0);
  for (const char* model : {"uncalibrated", "offsets_only", "geometric"}) {
    EXPECT_GT(summary["rmse_3d_mm"][model], 0.0);
    EXPECT_NEAR(summary["rmse_coordinate_mm"][model].get<double>() * std::sqrt(3.0),
                summary["rmse_3d_mm"][model].get<double>(), 1e-12);
    EXPECT_GT(summary["kfold"]["rmse_3d_mm"][model], 0.0);
  }
  // Noise of 0.2 mm a coordinate is 0.35 mm in 3-D; the fit takes a part of it away.
  EXPECT_LT(summary["rmse_3d_mm"]["geometric"], 0.35);
  EXPECT_GT(summary["kfold"]["rmse_3d_mm"]["geometric"], 0.34);
}

TEST_F(Program, SameInputSameFiles) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const auto files = {"arm6_calibrated.urdf", "calibration.yaml", "offsets.xacro"};
  std::vector<std::string> first;
  for (const char* file : files) first.push_back(ReadFile(std::filesystem::path(out_) / file));
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  std::size_t i = 0;
  for (const char* file : files) {
    EXPECT_EQ(ReadFile(std::filesystem::path(out_) / file), first[i++]) << file;
  }
}

TEST_F(Program, QuietPrintsNothing) {
  const ProgramResult result = Calibrate(project_, recording_, "--quiet");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err.find("error"), std::string::npos) << result.err;
}

// A project whose URDF is the calibrated one has nothing left to calibrate: offsets vanish.
TEST_F(Program, CalibratedUrdfNeedsNoCalibration) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  std::string project = ReadFile(project_);
  project.replace(project.find("arm6.urdf"), 9, "arm6_calibrated.urdf");
  const std::string again = out_ + "/project.yaml";
  std::ofstream(again) << project;
  const std::string json_file = (scratch_.path() / "again.json").string();
  ASSERT_EQ(RunProgram("calibrate " + again + " --recording " + recording_ + " -o " + out_ +
                       "/again --json " + json_file)
                .exit_code,
            0);
  const nlohmann::json summary = nlohmann::json::parse(ReadFile(json_file));
  const double before =
      nlohmann::json::parse(ReadFile(out_ + "/summary.json"))["rmse_3d_mm"]["geometric"];
  // Uncalibrated now means with the calibrated URDF: as good as the calibration was, but for marker
  // positions refitted.
  EXPECT_LT(summary["rmse_3d_mm"]["uncalibrated"], 1.05 * before);
}

TEST_F(Program, ValidateAppliesACalibrationToAnotherRecording) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const Project project = ReadProject(project_);
  const ErrorModel model = MakeErrorModel(project.tree, project.markers, project.placement);
  ErrorModel elsewhere = model;
  elsewhere.T_ref_waist = Transform(Eigen::Translation3d(0.3, 0.2, -0.1)) * RotY(1.0);
  WritePostureTable(scratch_.path() / "other.csv",
                    MakeSyntheticRecording(elsewhere, truth_, {.postures = 25, .seed = 9}),
                    project.tree);
  const std::string json_file = (scratch_.path() / "validate.json").string();
  const ProgramResult result = RunProgram(
      "validate " + project_ + " --calibration " + out_ + "/calibration.yaml" + " --recording " +
      (scratch_.path() / "other.csv").string() + " --json " + json_file);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json json = nlohmann::json::parse(ReadFile(json_file));
  EXPECT_LT(json["rmse_3d_mm"]["calibrated"], 0.4);
  EXPECT_GT(json["rmse_3d_mm"]["uncalibrated"], 3.0);
}

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
  EXPECT_LT(result.out.find("elbow_joint.theta"), result.out.find("shoulder_joint.theta"));
  const nlohmann::json json = nlohmann::json::parse(ReadFile(json_file));
  EXPECT_EQ(json["status"], "moved");
  EXPECT_EQ(json["moved"], nlohmann::json({"elbow_joint"}));
  EXPECT_EQ(json["with_covariance"], true);
  EXPECT_EQ(json["joints"][0]["joint"], "elbow_joint");
  const nlohmann::json& theta = json["parameters"][0];
  EXPECT_EQ(theta["name"], "elbow_joint.theta");
  EXPECT_EQ(theta["unit"], "rad");
  EXPECT_NEAR(theta["difference"].get<double>(), kChange, 4.0 * theta["sd"].get<double>());
  EXPECT_LT(theta["interval_95"][0], theta["difference"]);
  EXPECT_GT(theta["interval_95"][1], theta["difference"]);
  EXPECT_EQ(theta["significant"], true);
  EXPECT_FALSE(json["not_compared"].empty());
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
  refused(out_ + " " + later, {"covariance.csv:2", "another calibration"});
}

TEST_F(Program, EncoderOffsetsAreWrittenApart) {
  ASSERT_EQ(Calibrate(project_, recording_, "--zero-offsets encoder").exit_code, 0);
  const std::string xacro = ReadFile(out_ + "/offsets.xacro");
  EXPECT_NE(xacro.find("NOT in these origins"), std::string::npos);
  EXPECT_NE(xacro.find("name=\"elbow_joint_offset\""), std::string::npos) << xacro;
  EXPECT_NE(ReadFile(out_ + "/calibration.yaml").find("zero_offsets: encoder"), std::string::npos);
}

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

TEST_F(Program, NothingIsLeftWhenAnOutputCannotBeWritten) {
  const std::string file = scratch_.Write("file", "");
  const ProgramResult result = Calibrate(project_, recording_, "--json " + file + "/summary.json");
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_NE(result.err.find(file), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(out_));
}

TEST_F(Program, OutputsMayNotReplaceInputs) {
  const std::string before = ReadFile(recording_);
  ExpectRefused(Calibrate(project_, recording_, "--json " + recording_),
                {"recording.csv", "input"});
  EXPECT_EQ(ReadFile(recording_), before);
  const std::string project = scratch_.Write("arm6_project.yaml", ReadFile(project_));
  scratch_.Write("arm6.urdf", ReadFile(SourceFile("tests/robots/arm6.urdf")));
  ExpectRefused(RunProgram("inspect " + project + " --json " + project), {"input"});
  EXPECT_EQ(ReadFile(project), ReadFile(project_));
}

TEST_F(Program, JsonCanGoToStandardOutput) {
  const ProgramResult result = Calibrate(project_, recording_, "--json -");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out)["status"], "converged");
  const ProgramResult demo = RunProgram("demo --postures 15 --json - -o " + out_);
  EXPECT_EQ(nlohmann::json::parse(demo.out)["status"], "converged") << demo.err;
}

// Two joint columns exchanged: every number is fine, the whole is nonsense.
TEST_F(Program, NonsenseIsNotDeployed) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  std::string table = ReadFile(recording_);
  table.replace(table.find("elbow_joint"), 11, "elbow_jXint");
  table.replace(table.find("turret_joint"), 12, "elbow_joint");
  table.replace(table.find("elbow_jXint"), 11, "turret_joint");
  const ProgramResult result = Calibrate(project_, scratch_.Write("swapped.csv", table));
  EXPECT_EQ(result.exit_code, 4) << result.out;
  EXPECT_NE(result.err.find("does not explain this recording"), std::string::npos) << result.err;
  EXPECT_EQ(nlohmann::json::parse(ReadFile(out_ + "/summary.json"))["status"], "implausible");
  // Neither new results nor those of the run before.
  for (const char* file : {"arm6_calibrated.urdf", "calibration.yaml", "offsets.xacro"}) {
    EXPECT_FALSE(std::filesystem::exists(std::filesystem::path(out_) / file)) << file;
  }
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

TEST_F(Program, AJointBeyondItsLimitsIsAWarning) {
  std::string project = ReadFile(project_);
  std::string urdf = ReadFile(SourceFile("tests/robots/arm6.urdf"));
  const std::size_t joint = urdf.find("name=\"elbow_joint\"");
  const std::size_t upper = urdf.find("upper=\"", joint) + 7;
  const std::size_t lower = urdf.find("lower=\"", joint) + 7;
  for (const auto& [at, value] :
       {std::pair{std::max(upper, lower), upper > lower ? "0.1" : "-0.1"},
        std::pair{std::min(upper, lower), upper > lower ? "-0.1" : "0.1"}}) {
    urdf.replace(at, urdf.find('"', at) - at, value);
  }
  scratch_.Write("arm6.urdf", urdf);
  const ProgramResult result = Calibrate(scratch_.Write("tight.yaml", project), recording_);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("elbow_joint"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("beyond its limit"), std::string::npos) << result.err;
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
  ExpectRefused(Calibrate(project_, scaled("", 1000.0)), {"scaled.csv", "millimetres"});
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
  const ProgramResult result = RunProgram("demo --postures 25 -o " + out_);
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
  EXPECT_GE(inside, 0.85 * count);  // 95 % but for the scatter of one robot, whose errors correlate
  EXPECT_TRUE(std::filesystem::exists(out_ + "/talos_calibrated.urdf"));
}

}  // namespace
}  // namespace elastocal
