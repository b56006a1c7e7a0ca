// SPDX-License-Identifier: Apache-2.0
// The command `calibrate` as its users run it: files, exit codes and messages.

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "elastocal/files/output_files.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "tests/program_fixture.hpp"

namespace elastocal {
namespace {

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
  // Noise of 0.2 mm a coordinate is 0.35 mm in 3-D, of which the fit removes a part.
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

// A project with the calibrated URDF has nothing left to calibrate: all offsets are near zero.
TEST_F(Program, CalibratedUrdfNeedsNoCalibration) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  std::string project = ReadFile(project_);
  project.replace(project.find("arm6.urdf"), 9, "arm6_calibrated.urdf");
  const std::string again = out_ + "/project.yaml";
  std::ofstream(again) << project;
  const std::string json_file = (scratch_.path() / "again.json").string();
  ASSERT_EQ(RunProgram("calibrate " + again + " --recording " + recording_ + " -o " + out_ +
                       "/again --kfold 3 --json " + json_file)
                .exit_code,
            0);
  const nlohmann::json summary = nlohmann::json::parse(ReadFile(json_file));
  const double before =
      nlohmann::json::parse(ReadFile(out_ + "/summary.json"))["rmse_3d_mm"]["geometric"];
  // Uncalibrated now means with the calibrated URDF. The error is that of the calibration, with
  // refitted marker positions.
  EXPECT_LT(summary["rmse_3d_mm"]["uncalibrated"], 1.05 * before);
}

TEST_F(Program, EncoderOffsetsAreWrittenApart) {
  ASSERT_EQ(Calibrate(project_, recording_, "--zero-offsets encoder --kfold 3").exit_code, 0);
  const std::string xacro = ReadFile(out_ + "/offsets.xacro");
  EXPECT_NE(xacro.find("NOT in these origins"), std::string::npos);
  EXPECT_NE(xacro.find("name=\"elbow_joint_offset\""), std::string::npos) << xacro;
  EXPECT_NE(ReadFile(out_ + "/calibration.yaml").find("zero_offsets: encoder"), std::string::npos);
}

TEST_F(Program, NothingIsLeftWhenAnOutputCannotBeWritten) {
  const std::string file = scratch_.Write("file", "");
  const ProgramResult result =
      Calibrate(project_, recording_, "--kfold 3 --json " + file + "/summary.json");
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
  const ProgramResult result = Calibrate(project_, recording_, "--kfold 3 --json -");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out)["status"], "converged");
  const ProgramResult demo = RunProgram("demo --quick --count 5 --json - -o " + out_);
  EXPECT_EQ(nlohmann::json::parse(demo.out)["status"], "converged") << demo.err;
}

// Two joint columns are exchanged: every number is plausible, but the whole is not.
TEST_F(Program, NonsenseIsNotDeployed) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  std::string table = ReadFile(recording_);
  table.replace(table.find("elbow_joint"), 11, "elbow_jXint");
  table.replace(table.find("turret_joint"), 12, "elbow_joint");
  table.replace(table.find("elbow_jXint"), 11, "turret_joint");
  const ProgramResult result = Calibrate(project_, scratch_.Write("swapped.csv", table));
  EXPECT_EQ(result.exit_code, 4) << result.out;
  EXPECT_NE(result.err.find("turret_joint and elbow_joint: their positions are exchanged"),
            std::string::npos)
      << result.err;
  // The effect of the mistake on the fit is not reported as well.
  EXPECT_EQ(result.err.find("does not explain this recording"), std::string::npos) << result.err;
  EXPECT_EQ(nlohmann::json::parse(ReadFile(out_ + "/summary.json"))["status"], "implausible");
  // Neither new results nor those of the run before may remain.
  for (const char* file : {"arm6_calibrated.urdf", "calibration.yaml", "offsets.xacro"}) {
    EXPECT_FALSE(std::filesystem::exists(std::filesystem::path(out_) / file)) << file;
  }
}

/// Writes a table of the fixture's arm.
std::string WriteTable(const ScratchFolder& scratch, const Project& project,
                       const Recording& table) {
  WritePostureTable(scratch.path() / "table.csv", table, project.tree);
  return (scratch.path() / "table.csv").string();
}

// No gear is made so badly, so the column has another unit or is for another gear.
TEST_F(Program, AWrongGainInATableIsNamedAndCorrectedOnRequest) {
  Recording table = MakeSyntheticRecording(model_, truth_, {.postures = 40, .seed = 5});
  table.q.col(Coordinate("elbow_joint")) *= 1.02;
  const std::string file = WriteTable(scratch_, arm_, table);
  const ProgramResult found = Calibrate(project_, file);
  EXPECT_EQ(found.exit_code, 4) << found.out;
  const std::string name = "--accept gain:elbow_joint=1.0";
  EXPECT_NE(found.out.find("elbow_joint: its positions are 1.0"), std::string::npos) << found.out;
  const std::size_t at = found.out.find(name);
  ASSERT_NE(at, std::string::npos) << found.out;
  const std::string accepted = found.out.substr(at, found.out.find(' ', at + 9) - at);
  EXPECT_EQ(Calibrate(project_, file, accepted + kFewFolds).exit_code, 0) << accepted;
}

// A wrong scale of the cameras shows in no residual. Noise that all markers of a body share is no
// fault with a name.
TEST_F(Program, AVerdictSaysWhatItRestsOn) {
  Random random(1);
  Eigen::VectorXd truth = truth_;  // its links show how large their own errors are
  for (int i = 0; i < model_.parameter_count(); ++i) {
    const Parameter& parameter = model_.parameters[static_cast<std::size_t>(i)];
    const bool length = parameter.joint >= 0 && GroupOf(parameter.kind) == PriorGroup::kLengths;
    if (length) truth[i] += random.Normal(5e-3);
  }
  Recording recording = MakeSyntheticRecording(model_, truth, {.postures = 30, .seed = 5});
  const auto said = [&](const std::string& of_project) {
    return Calibrate(of_project, WriteTable(scratch_, arm_, recording), "--kfold 0").out;
  };
  const std::string scale = "The scale of the cameras is taken as right";
  const std::string told = said(project_);  // the travel of the rail tells the scale
  EXPECT_EQ(told.find(scale), std::string::npos) << told;
  std::string text = ReadFile(project_);
  text.replace(text.find("arm6.urdf"), 9, SourceFile("tests/robots/arm6.urdf").string());
  const std::string lead =
      scratch_.Write("lead.yaml", text + "\ncalibration: {extra: [rail_joint.gear]}\n");
  const std::string clean = said(lead);
  EXPECT_NE(clean.find(scale), std::string::npos) << clean;
  const std::size_t open = clean.find("only tell that it is 0.9");
  ASSERT_NE(open, std::string::npos) << clean;
  EXPECT_NE(clean.find("m from the root link up to ", open), std::string::npos) << clean;
  EXPECT_EQ(clean.find("of a body as a whole"), std::string::npos) << clean;
  for (int i = 0; i < recording.posture_count(); ++i) {
    const Eigen::RowVector3d shift = random.NormalVector(3, 6e-4).transpose();
    for (int m = 0; m < recording.marker_count(); ++m) {
      if (recording.marker_names[static_cast<std::size_t>(m)].starts_with("TOOL")) {
        recording.markers.block<1, 3>(i, 3 * m) += shift;
      }
    }
  }
  const std::string swinging = said(project_);
  EXPECT_NE(swinging.find("of a body as a whole 0."), std::string::npos) << swinging;
}

// In the fit, so few postures err by a third of their error when they are held out.
TEST_F(Program, FewPosturesAreJudgedWhereTheyAreLeftOut) {
  const std::string file = WriteTable(
      scratch_, arm_, MakeSyntheticRecording(model_, truth_, {.postures = 6, .seed = 5}));
  const ProgramResult result = Calibrate(project_, file, "");
  const auto summary = nlohmann::json::parse(ReadFile(out_ + "/summary.json"));
  EXPECT_EQ(summary["deployed"]["judged_on"], "held-out postures") << result.out << result.err;
  EXPECT_NE(result.out.find("6-fold RMSE"), std::string::npos) << result.out;
}

// There are just as many equations as the arm needs. Without some postures, there are too few.
TEST_F(Program, FoldsThatNobodyAskedForAreLeftOutWhereTheyAreTooSmall) {
  const int unknowns =
      static_cast<int>(FindBaseParameters(model_, arm_.identifiability).kept.size());
  const int postures = unknowns / (3 * model_.marker_count()) + 1;
  const std::string file = WriteTable(
      scratch_, arm_, MakeSyntheticRecording(model_, truth_, {.postures = postures, .seed = 5}));
  const ProgramResult usual = Calibrate(project_, file, "");
  EXPECT_NE(usual.exit_code, 3) << usual.err;
  EXPECT_NE(usual.err.find("not cross-validated: "), std::string::npos) << usual.err;
  EXPECT_EQ(Calibrate(project_, file, "--kfold 2").exit_code, 3);
}

TEST_F(Program, JointsThatStoodStillAreNamed) {
  const int turret = Coordinate("turret_joint");
  Recording table = MakeSyntheticRecording(model_, truth_, {.postures = 20, .seed = 5});
  const Geometry geometry = ApplyErrors(model_, truth_);
  table.q.col(turret).setConstant(0.3);
  for (int i = 0; i < table.posture_count(); ++i) {
    table.markers.row(i) =
        MarkerPositions(model_, geometry, table.q.row(i).transpose()).reshaped().transpose();
  }
  const ProgramResult result = Calibrate(project_, WriteTable(scratch_, arm_, table));
  EXPECT_NE(result.err.find("turret_joint stood still in all postures"), std::string::npos)
      << result.err;
  EXPECT_EQ(Calibrate(project_, recording_).err.find("stood still"), std::string::npos);
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

TEST_F(Program, ARobotWithoutLegsHasNoTableOfLegs) {
  std::string project = ReadFile(project_);
  project.replace(project.find("arm6.urdf"), 9, SourceFile("tests/robots/arm6.urdf").string());
  const std::string elastic =
      scratch_.Write("p.yaml", project + "elasticity: {torsion: [shoulder_joint]}\n");
  const std::string text = Calibrate(elastic, recording_, " --kfold 0 --verbose").out;
  EXPECT_NE(text.find("shoulder_joint.compliance_z"), std::string::npos) << text;
  EXPECT_EQ(text.find("leg at the waist"), std::string::npos) << text;
}

// A joint that rests while others are measured seems frozen if those are wrong. Without their
// postures, the joint is fine.
TEST_F(Program, AJointAtRestIsNotCalledFrozenForAnothersSign) {
  const auto coordinate = [&](const char* name) {
    return arm_.tree.joints[static_cast<std::size_t>(FindJoint(arm_.tree, name))].coordinate;
  };
  constexpr int kHalf = 25;
  Recording recording = MakeSyntheticRecording(model_, truth_, {.postures = 2 * kHalf, .seed = 4});
  const int elbow = coordinate("elbow_joint"), rail = coordinate("rail_joint");
  const int turret = coordinate("turret_joint");
  recording.q.col(elbow).head(kHalf).setZero();
  recording.q.col(rail).tail(kHalf).setZero();
  recording.q.col(turret).tail(kHalf).setZero();
  const Geometry geometry = ApplyErrors(model_, truth_);
  for (int i = 0; i < 2 * kHalf; ++i) {
    recording.markers.row(i) =
        MarkerPositions(model_, geometry, recording.q.row(i).transpose()).reshaped().transpose();
  }
  recording.q.col(elbow) *= -1.0;
  const std::string table = (scratch_.path() / "sign.csv").string();
  WritePostureTable(table, recording, arm_.tree);
  const ProgramResult named = Calibrate(project_, table);
  EXPECT_EQ(named.exit_code, 4) << named.out << named.err;
  EXPECT_NE(named.out.find("--accept sign:elbow_joint corrects it"), std::string::npos)
      << named.out;
  EXPECT_EQ(Calibrate(project_, table, "--accept sign:elbow_joint --kfold 3").exit_code, 0);
}

// A wrong scale of the cameras changes the travel of a sliding joint most.
TEST_F(Program, AGainOfASlidingJointMayBeTheScaleOfTheCameras) {
  Recording recording = MakeSyntheticRecording(model_, truth_, {.postures = 40, .seed = 4});
  recording.markers *= 1.01;
  const std::string table = (scratch_.path() / "scaled.csv").string();
  WritePostureTable(table, recording, arm_.tree);
  const ProgramResult result = Calibrate(project_, table);
  EXPECT_EQ(result.exit_code, 4) << result.out << result.err;
  EXPECT_NE(result.out.find("the cameras"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("or those of rail_joint 0.990"), std::string::npos) << result.out;
  // Its long travel tells the scale far better than the lengths of links.
  const std::string name = "--accept scale=";
  ASSERT_NE(result.out.find(name), std::string::npos) << result.out;
  EXPECT_NEAR(std::stod(result.out.substr(result.out.find(name) + name.size())), 1.01, 3e-4);
}

}  // namespace
}  // namespace elastocal
