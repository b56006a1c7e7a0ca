// SPDX-License-Identifier: Apache-2.0
// The report as users get it: after `calibrate` and `validate`, and by `elastocal report`.

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "elastocal/files/output_files.hpp"
#include "elastocal/io/posture_table.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "tests/run_program.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::json;

/// The floats of report_data.json, decoded by other code than that which wrote them.
std::vector<double> Floats(const std::string& base64) {
  static const std::string digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<double> values;
  std::uint64_t bits = 0;
  int count = 0;
  std::vector<unsigned char> bytes;
  for (const char c : base64) {
    if (c == '=') break;
    bits = bits << 6U | digits.find(c);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<unsigned char>(bits >> count & 0xffU));
  }
  for (std::size_t i = 0; i + 4 <= bytes.size(); i += 4) {
    const std::uint32_t word = bytes[i] | bytes[i + 1] << 8U | bytes[i + 2] << 16U |
                               static_cast<std::uint32_t>(bytes[i + 3]) << 24U;
    values.push_back(static_cast<double>(std::bit_cast<float>(word)));
  }
  return values;
}

class Report : public ::testing::Test {
 protected:
  void SetUp() override {
    project_ = SourceFile("tests/robots/arm6_project.yaml").string();
    recording_ = (scratch_.path() / "recording.csv").string();
    out_ = (scratch_.path() / "out").string();
    Record(1);
  }

  void Record(std::uint64_t seed) {
    const Project project = ReadProject(project_);
    const ErrorModel model = MakeErrorModel(project.tree, project.markers, project.placement);
    const BaseParameters base = FindBaseParameters(model, project.identifiability);
    const Eigen::VectorXd truth = DrawErrors(model, base.kept, {{ParameterKind::kTheta, 0.01}}, 1);
    WritePostureTable(recording_,
                      MakeSyntheticRecording(model, truth, {.postures = 25, .seed = seed}),
                      project.tree);
  }

  ProgramResult Calibrate(const std::string& more = " --kfold 3") {
    return RunProgram("calibrate " + project_ + " --recording " + recording_ + " -o " + out_ +
                      more);
  }
  Json Read(const std::string& name) const { return Json::parse(ReadFile(out_ + "/" + name)); }

  /// The data of a report.
  static Json DataOf(const std::string& file) {
    const std::string page = ReadFile(file);
    const std::string before = "id=\"report-data\">";
    const std::size_t begin = page.find(before) + before.size();
    return Json::parse(page.substr(begin, page.find("</script>", begin) - begin));
  }

  ScratchFolder scratch_;
  std::string project_, recording_, out_;
};

TEST_F(Report, CalibrateWritesWhatThePageShows) {
  ASSERT_EQ(Calibrate(" --kfold 3 --seed 3").exit_code, 0);
  const Json data = Read("report_data.json");
  const Json summary = Read("summary.json");
  ASSERT_EQ(data["scenes"].size(), 1u);
  const Json& scene = data["scenes"][0];
  const std::vector<double> measured = Floats(scene["measured"]);
  for (const std::string model : {"uncalibrated", "geometric"}) {
    const std::vector<double> predicted = Floats(scene["predicted"][model]);
    ASSERT_EQ(predicted.size(), 3 * scene["markers"].size() * 25);
    double squares = 0.0;
    for (std::size_t i = 0; i < predicted.size(); ++i) {
      squares += std::pow(1e3 * (predicted[i] - measured[i]), 2);
    }
    // The positions of the view must give the figure of the summary. Floats of about a metre are
    // accurate to 1e-4 mm.
    EXPECT_NEAR(std::sqrt(3.0 * squares / static_cast<double>(predicted.size())),
                summary["rmse_3d_mm"][model].get<double>(), 1e-3);
  }
  const Json& counts = data["distributions"][0]["counts"]["geometric"];
  int sightings = 0;
  for (const Json& count : counts) sightings += count.get<int>();
  EXPECT_EQ(3 * sightings, summary["equations"].get<int>());
}

TEST_F(Report, TakesMeshesAlong) {
  // A package with the URDF in one folder and a mesh in another, as robots are published.
  std::string urdf = ReadFile(SourceFile("tests/robots/arm6.urdf"));
  urdf.insert(
      urdf.rfind("</robot>"),
      R"(<!-- filename="package://my_robot/meshes/a.stl" filename="package://other/b.stl" -->)");
  std::filesystem::create_directories(scratch_.path() / "my_robot" / "meshes");
  std::filesystem::create_directories(scratch_.path() / "my_robot" / "urdf");
  scratch_.Write("my_robot/meshes/a.stl", "abc");
  scratch_.Write("my_robot/urdf/arm6.urdf", urdf);
  project_ = scratch_.Write("my_robot/urdf/arm6_project.yaml",
                            ReadFile(SourceFile("tests/robots/arm6_project.yaml")));
  ASSERT_EQ(Calibrate().exit_code, 0);
  EXPECT_EQ(Read("report_data.json")["robot"]["meshes"],
            (Json{{"package://my_robot/meshes/a.stl", "YWJj"}}));
}

TEST_F(Report, SaysHowToGetTheSameAgain) {
  ASSERT_EQ(Calibrate(" --kfold 3 --seed 3").exit_code, 0);
  const Json run = Read("runs.json")["calibrate"];
  EXPECT_EQ(run["seed"], 3);
  EXPECT_EQ(run["command_line"], "elastocal calibrate " + project_ + " --recording " + recording_ +
                                     " -o " + out_ + " --kfold 3 --seed 3");
  ASSERT_EQ(run["inputs"].size(), 3u);  // project, URDF, recording
  EXPECT_EQ(run["inputs"][2]["file"], recording_);
  EXPECT_EQ(run["inputs"][2]["bytes"], std::filesystem::file_size(recording_));
}

TEST_F(Report, TheRecordIsReadFromAnyFolder) {
  // The command is typed in the recording's folder, with relative names.
  std::filesystem::copy(project_, scratch_.path() / "arm6_project.yaml");
  std::filesystem::copy(SourceFile("tests/robots/arm6.urdf"), scratch_.path() / "arm6.urdf");
  const std::string recording = std::filesystem::path(recording_).filename().string();
  const std::string go = "cd " + scratch_.path().string() + " && " + ProgramFile();
  ASSERT_EQ(std::system(
                (go + " calibrate arm6_project.yaml --recording " + recording + " -o typed --quiet")
                    .c_str()),
            0);
  const std::string out = (scratch_.path() / "typed").string();
  const ProgramResult elsewhere = RunProgram("diagnose " + out);
  EXPECT_EQ(elsewhere.exit_code, 0) << elsewhere.err;

  std::ofstream(recording_, std::ios::app) << "\n";
  const ProgramResult changed = RunProgram("diagnose " + out);
  EXPECT_EQ(changed.exit_code, 3);
  EXPECT_NE(changed.err.find("has changed since the calibration"), std::string::npos)
      << changed.err;
}

#ifdef ELASTOCAL_HAS_PAGE

TEST_F(Report, EndsCalibrateAndValidate) {
  const ProgramResult calibrated = Calibrate();
  ASSERT_EQ(calibrated.exit_code, 0) << calibrated.err;
  EXPECT_NE(calibrated.out.find("Report: " + out_ + "/report.html"), std::string::npos);
  const Json report = DataOf(out_ + "/report.html");
  EXPECT_EQ(report["summary"], Read("summary.json"));
  EXPECT_EQ(report["data"], Read("report_data.json"));

  Record(2);
  const ProgramResult validated =
      RunProgram("validate " + project_ + " --calibration " + out_ +
                 "/calibration.yaml --recording " + recording_ + " -o " + out_);
  ASSERT_EQ(validated.exit_code, 0) << validated.err;
  const Json both = DataOf(out_ + "/report.html");
  EXPECT_EQ(both["validation"]["status"], "better");
  EXPECT_TRUE(both["runs"].contains("calibrate"));
  EXPECT_TRUE(both["runs"].contains("validate"));
}

TEST_F(Report, LeavesOutWhatIsOfAnotherCalibration) {
  ASSERT_EQ(Calibrate().exit_code, 0);
  const ProgramResult diagnosed =
      RunProgram("diagnose " + out_ + " --json " + out_ + "/diagnosis.json");
  ASSERT_EQ(diagnosed.exit_code, 0) << diagnosed.err;
  Record(2);
  ASSERT_EQ(RunProgram("validate " + project_ + " --calibration " + out_ + " --recording " +
                       recording_ + " -o " + out_)
                .exit_code,
            0);
  ASSERT_EQ(RunProgram("report " + out_).exit_code, 0);
  const Json before = DataOf(out_ + "/report.html");
  EXPECT_TRUE(before.contains("validation"));
  EXPECT_TRUE(before.contains("diagnosis"));

  ASSERT_EQ(Calibrate().exit_code, 0);  // with the second recording
  const Json after = DataOf(out_ + "/report.html");
  EXPECT_FALSE(after.contains("validation"));
  EXPECT_FALSE(after.contains("diagnosis"));
  const std::string missing = after["missing"].dump();
  EXPECT_NE(missing.find("validation.json is of another calibration"), std::string::npos);
  EXPECT_NE(missing.find("diagnosis.json is of another calibration"), std::string::npos);
}

TEST_F(Report, ShowsEarlierCalibrationsAndGoesWhereItIsTold) {
  ASSERT_EQ(Calibrate().exit_code, 0);
  const std::string file = (scratch_.path() / "page.html").string();
  const ProgramResult result =
      RunProgram("report " + out_ + " --earlier " + out_ + "/calibration.yaml -o " + file);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json report = DataOf(file);
  ASSERT_EQ(report["calibrations"].size(), 2u);
  const std::size_t names = report["correlation"]["names"].size();
  const std::string lower = report["correlation"]["lower"];
  EXPECT_EQ(lower.size(), (names * (names + 1) / 2 + 2) / 3 * 4);  // a byte a pair, in base64
}

TEST_F(Report, RefusesAnEarlierCalibrationOfAnotherRobot) {
  ASSERT_EQ(Calibrate().exit_code, 0);
  std::string text = ReadFile(out_ + "/calibration.yaml");
  const std::size_t at = text.find("nominal: \"");
  ASSERT_NE(at, std::string::npos);
  const std::string other =
      scratch_.Write("other.yaml", text.replace(at, 27, "nominal: \"0123456789abcdef\""));
  const ProgramResult refused = RunProgram("report " + out_ + " --earlier " + other);
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NE(refused.err.find("other.yaml: is of robot 'arm6'"), std::string::npos) << refused.err;
}

TEST_F(Report, NeverReplacesWhatItShows) {
  ASSERT_EQ(Calibrate().exit_code, 0);
  std::filesystem::copy(out_, out_ + "_earlier");
  std::ofstream(out_ + "/postures_summary.json") << "{}";
  for (const std::string& input : {out_ + "/postures_summary.json", out_ + "/covariance.csv",
                                   out_ + "_earlier/covariance.csv"}) {
    const std::string before = ReadFile(input);
    for (const char* option : {" --json ", " -o "}) {
      const ProgramResult result =
          RunProgram("report " + out_ + " --earlier " + out_ + "_earlier" + option + input);
      EXPECT_EQ(result.exit_code, 3) << input;
      EXPECT_NE(result.err.find("input"), std::string::npos) << result.err;
      EXPECT_EQ(ReadFile(input), before);
    }
  }
}

TEST_F(Report, AFolderWithoutResultsIsBadInput) {
  std::filesystem::create_directory(out_);
  const ProgramResult empty = RunProgram("report " + out_);
  EXPECT_EQ(empty.exit_code, 3);
  EXPECT_NE(empty.err.find("nothing to report"), std::string::npos) << empty.err;
  EXPECT_EQ(RunProgram("report " + out_ + "/absent").exit_code, 3);
  std::ofstream(out_ + "/summary.json") << "{";
  const ProgramResult broken = RunProgram("report " + out_);
  EXPECT_EQ(broken.exit_code, 3);
  EXPECT_NE(broken.err.find("summary.json"), std::string::npos) << broken.err;
  EXPECT_EQ(RunProgram("report " + out_ + " -o " + out_ + "/summary.json").exit_code, 3);
}

#else

TEST_F(Report, WithoutThePageTheProgramSaysWhatItLacks) {
  const ProgramResult calibrated = Calibrate();
  EXPECT_EQ(calibrated.exit_code, 0) << calibrated.err;
  EXPECT_NE(calibrated.out.find("built without Node.js"), std::string::npos) << calibrated.out;
  EXPECT_FALSE(std::filesystem::exists(out_ + "/report.html"));
  const ProgramResult report = RunProgram("report " + out_);
  EXPECT_EQ(report.exit_code, 4);
  EXPECT_NE(report.err.find("built without Node.js"), std::string::npos) << report.err;
}

#endif

}  // namespace
}  // namespace elastocal
