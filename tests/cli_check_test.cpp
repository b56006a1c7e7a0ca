// SPDX-License-Identifier: Apache-2.0
// The command `check` as its users run it.

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "elastocal/files/output_files.hpp"
#include "elastocal/math/numbers.hpp"
#include "tests/another_day.hpp"
#include "tests/arm_with_tracker.hpp"
#include "tests/program_fixture.hpp"

namespace elastocal {
namespace {

TEST_F(Program, CheckNamesTheJointThatMovedAndEndsWithFour) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  constexpr double kChange = 4e-3;
  const std::string same =
      AnotherDay(scratch_.path() / "same.csv", project_, truth_, "elbow_joint.theta", 0.0);
  const std::string moved =
      AnotherDay(scratch_.path() / "moved.csv", project_, truth_, "elbow_joint.theta", kChange);
  const std::string words = "check " + project_ + " --calibration " + out_ + " --recording ";

  const ProgramResult fine = RunProgram(words + same);
  EXPECT_EQ(fine.exit_code, 0) << fine.err;
  EXPECT_TRUE(fine.out.starts_with("Unchanged")) << fine.out;

  const std::string file = (scratch_.path() / "check.json").string();
  const ProgramResult found = RunProgram(words + moved + " --json " + file);
  EXPECT_EQ(found.exit_code, 4) << found.err;
  EXPECT_TRUE(found.out.starts_with("Moved: elbow_joint (elbow_joint.theta by 0.2")) << found.out;
  const nlohmann::json json = nlohmann::json::parse(ReadFile(file));
  EXPECT_EQ(json["status"], "moved");
  ASSERT_EQ(json["moved"].size(), 1u);
  const nlohmann::json& change = json["moved"][0]["changes"][0];
  EXPECT_NEAR(change["change"].get<double>(), kChange, 4.0 * change["sd"].get<double>());
  EXPECT_LT(json["rmse_3d_mm"]["updated"], json["rmse_3d_mm"]["calibrated"]);
}

// Markers on the last link determine the zero of its joint. Three markers that are glued anew seem
// to turn it.
TEST_F(Program, CheckTellsTheLastJointByMarkersThatStayed) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const std::string file = (scratch_.path() / "check.json").string();
  const auto check = [&](const std::string& day, const Eigen::VectorXd& truth) {
    const std::string table =
        AnotherDay(scratch_.path() / (day + ".csv"), project_, truth, "flange_joint.theta", 5e-3);
    const ProgramResult result = RunProgram("check " + project_ + " --calibration " + out_ +
                                            " --recording " + table + " --json " + file);
    EXPECT_EQ(result.exit_code, day == "stayed" ? 4 : 0) << result.out << result.err;
    return result.out;
  };
  const auto tool = [](const nlohmann::json& json) {
    for (const nlohmann::json& link : json["markers"]) {
      if (link["link"] == "tool") return link;
    }
    return nlohmann::json();
  };
  const std::string stayed = check("stayed", truth_);
  EXPECT_TRUE(stayed.starts_with("Moved: flange_joint (flange_joint.theta by ")) << stayed;
  EXPECT_NE(stayed.find("Or all markers on tool moved as one piece."), std::string::npos);
  nlohmann::json json = nlohmann::json::parse(ReadFile(file));
  EXPECT_EQ(json["or_markers"], nlohmann::json({"tool"}));
  const nlohmann::json& change = json["moved"][0]["changes"][0];
  EXPECT_NEAR(change["change"].get<double>(), 5e-3, 3.0 * change["sd"].get<double>());
  EXPECT_LT(change["sd"], 1.5e-3);
  EXPECT_EQ(tool(json)["same"], true);
  EXPECT_TRUE(json["not_told"].empty()) << json["not_told"];

  Eigen::VectorXd anew = truth_;
  anew[FindParameter(model_.parameters, "marker.TOOL_1.x")] += 2e-3;
  anew[FindParameter(model_.parameters, "marker.TOOL_2.y")] -= 2e-3;
  EXPECT_TRUE(check("anew", anew).starts_with("Unchanged"));
  json = nlohmann::json::parse(ReadFile(file));
  EXPECT_EQ(tool(json)["same"], false);
  EXPECT_EQ(json["not_told"], nlohmann::json({"flange_joint"}));
}

// The project was corrected since then, but the markers have not moved.
TEST_F(Program, CheckKnowsMarkersThatTheProjectNowHasElsewhere) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const std::string table =
      AnotherDay(scratch_.path() / "same.csv", project_, truth_, "elbow_joint.theta", 0.0);
  std::string text = ReadFile(project_);
  const std::string before = "[25, 45, 20]", now = "[31, 42, 20]";
  ASSERT_NE(text.find(before), std::string::npos);
  text.replace(text.find(before), before.size(), now);
  const std::string urdf = "arm6.urdf";
  ASSERT_NE(text.find(urdf), std::string::npos);
  text.replace(text.find(urdf), urdf.size(), SourceFile("tests/robots/" + urdf));
  const std::string corrected = scratch_.Write("corrected.yaml", text);
  const std::string file = (scratch_.path() / "check.json").string();
  const ProgramResult result = RunProgram("check " + corrected + " --calibration " + out_ +
                                          " --recording " + table + " --json " + file);
  EXPECT_TRUE(result.out.starts_with("Unchanged")) << result.out << result.err;
  for (const nlohmann::json& link : nlohmann::json::parse(ReadFile(file))["markers"]) {
    EXPECT_EQ(link["same"], true) << link;
  }
}

// Four postures of one marker do not tell the joint at this level of confidence, but they tell that
// the calibration no longer holds.
TEST_F(Program, CheckSaysChangedWhereTooFewPosturesTellTheJoint) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  Eigen::VectorXd truth = truth_;
  truth[FindParameter(model_.parameters, "elbow_joint.theta")] += 0.05;
  Recording few = MakeSyntheticRecording(model_, truth, {.postures = 4, .seed = 5});
  const int seen = few.marker_count() - 1;  // the last one is on the hand
  for (int m = 0; m < seen; ++m) few.markers.middleCols(3 * m, 3).setConstant(std::nan(""));
  const std::filesystem::path table = scratch_.path() / "few.csv";
  WritePostureTable(table, few, arm_.tree);
  const std::string file = (scratch_.path() / "check.json").string();
  const ProgramResult result =
      RunProgram("check " + project_ + " --calibration " + out_ + " --recording " + table.string() +
                 " --level 0.001 --json " + file);
  EXPECT_EQ(result.exit_code, 4) << result.out << result.err;
  EXPECT_TRUE(result.out.starts_with("Changed: the calibrated robot errs by")) << result.out;
  EXPECT_EQ(nlohmann::json::parse(ReadFile(file))["status"], "changed");
}

// No moved joint explains these recordings. "unchanged" would be the worst answer.
TEST_F(Program, CheckAndValidateSayWhatIsWrongWithARecording) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const int elbow = Coordinate("elbow_joint");
  Recording reversed = MakeSyntheticRecording(model_, truth_, {.postures = 12, .seed = 5});
  Recording shifted = reversed, shuffled = reversed;
  shifted.markers.topRows(11) = reversed.markers.bottomRows(11);  // of the next posture
  shuffled.markers = reversed.markers.colwise().reverse().eval();
  reversed.q.col(elbow) *= -1.0;
  const std::string json = (scratch_.path() / "found.json").string();
  const auto run = [&](const std::string& command, const Recording& recording) {
    WritePostureTable(scratch_.path() / "wrong.csv", recording, arm_.tree);
    const ProgramResult result =
        RunProgram(command + " " + project_ + " --calibration " + out_ + " --recording " +
                   (scratch_.path() / "wrong.csv").string() + " --json " + json);
    EXPECT_EQ(result.exit_code, 4) << command << result.out << result.err;
    return result.out + result.err;
  };
  const auto status = [&] { return nlohmann::json::parse(ReadFile(json))["status"]; };
  EXPECT_NE(run("check", reversed).find("The recording is wrong: elbow_joint: the sign"),
            std::string::npos);
  EXPECT_EQ(status(), "recording wrong");
  EXPECT_NE(run("check", shifted)
                .find("The recording is wrong: markers belong to the joint positions of the next "
                      "row"),
            std::string::npos);
  EXPECT_NE(run("check", shuffled).find("Not explained: the calibrated robot errs by"),
            std::string::npos);
  EXPECT_EQ(status(), "implausible");
  EXPECT_NE(run("validate", reversed).find("elbow_joint: the sign of its positions is reversed"),
            std::string::npos);
  EXPECT_NE(run("validate", shuffled).find("do not belong together"), std::string::npos);
  EXPECT_EQ(status(), "implausible");
}

// One of twelve postures is wrong.
TEST_F(Program, CheckNamesNoJointBesideErrorsThatNoneExplains) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const int elbow = Coordinate("elbow_joint");
  Recording bad = MakeSyntheticRecording(model_, truth_, {.postures = 12, .seed = 5});
  bad.q(4, elbow) += 0.05;
  const std::filesystem::path table = scratch_.path() / "today.csv";
  WritePostureTable(table, bad, arm_.tree);
  const std::string file = (scratch_.path() / "check.json").string();
  const ProgramResult result = RunProgram("check " + project_ + " --calibration " + out_ +
                                          " --recording " + table.string() + " --json " + file);
  EXPECT_EQ(result.exit_code, 4) << result.err;
  EXPECT_TRUE(result.out.starts_with("Not explained: even if every joint may have moved"))
      << result.out;
  EXPECT_NE(result.out.find("Farthest off: line 6 ("), std::string::npos) << result.out;
  const nlohmann::json json = nlohmann::json::parse(ReadFile(file));
  EXPECT_EQ(json["status"], "unexplained");
  EXPECT_GT(json["rmse_3d_mm"]["updated"], 4.0 * json["left_by_calibration_mm"].get<double>());
  EXPECT_TRUE(json["alternatives"].empty());
}

// The gain of a joint and the scale of the cameras look like several moved joints.
TEST_F(Program, CheckNamesAGainAndAScale) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const int elbow = Coordinate("elbow_joint");
  const Recording sound = MakeSyntheticRecording(model_, truth_, {.postures = 12, .seed = 5});
  Recording gain = sound, scale = sound;
  gain.q.col(elbow) *= 1.03;
  scale.markers *= 1.002;
  const auto expect = [&](const Recording& recording, const std::string& begin, double size) {
    const std::filesystem::path table = scratch_.path() / "today.csv";
    WritePostureTable(table, recording, arm_.tree);
    const std::string file = (scratch_.path() / "check.json").string();
    const std::string words = "check " + project_ + " --calibration " + out_ + " --recording " +
                              table.string() + " --json " + file;
    const ProgramResult result = RunProgram(words);
    EXPECT_EQ(result.exit_code, 4) << result.err;
    EXPECT_TRUE(result.out.starts_with("The recording seems wrong, not the robot: " + begin))
        << result.out;
    const nlohmann::json json = nlohmann::json::parse(ReadFile(file));
    EXPECT_EQ(json["status"], "recording wrong");
    ASSERT_EQ(json["alternatives"].size(), 1u) << result.out;
    const std::string text = json["alternatives"][0];
    const std::size_t at = text.find("--accept ") + 9;
    const std::string name = text.substr(at, text.find(' ', at) - at);
    EXPECT_NEAR(std::stod(name.substr(name.find('=') + 1)), size, 4e-4) << name;
    const ProgramResult accepted = RunProgram(words + " --accept " + name);
    EXPECT_EQ(accepted.exit_code, 0) << accepted.out << accepted.err;
  };
  expect(gain, "elbow_joint: its positions are 1.0", 1.03);
  expect(scale, "the cameras' positions are 1.00", 1.002);
}

// The error of a posture is that of the markers that were seen in it.
TEST_F(Program, CheckMeasuresPosturesWithHiddenMarkers) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  Recording today = MakeSyntheticRecording(model_, truth_, {.postures = 12, .seed = 5});
  for (int i = 0; i < today.posture_count(); i += 3) {
    today.markers.block<1, 3>(i, 0).setConstant(std::nan(""));
  }
  const std::filesystem::path table = scratch_.path() / "today.csv";
  WritePostureTable(table, today, arm_.tree);
  const std::string file = (scratch_.path() / "check.json").string();
  RunProgram("check " + project_ + " --calibration " + out_ + " --recording " + table.string() +
             " --json " + file);
  const nlohmann::json left = nlohmann::json::parse(ReadFile(file))["left_by_posture_mm"];
  ASSERT_EQ(left.size(), 12u);
  for (const nlohmann::json& one : left) EXPECT_GT(one.is_null() ? 0.0 : one.get<double>(), 0.0);
}

class ArmProgram : public ArmWithTracker {};

TEST_F(ArmProgram, ChecksTablesOfATrackerInSeveralFiles) {
  const std::string words = "check " + (folder_.path() / "project.yaml").string() +
                            " --calibration " + WriteCalibration().string() + " --recording ";
  MoveTracker();
  const auto tables = [&] {
    return Table(q_.topRows(5), "a.csv").string() + " " +
           Table(q_.middleRows(5, 5), "b.csv", 5).string();
  };
  const ProgramResult fine = RunProgram(words + tables());
  EXPECT_EQ(fine.exit_code, 0) << fine.err;
  EXPECT_TRUE(fine.out.starts_with("Unchanged")) << fine.out;
  EXPECT_NE(fine.out.find("position mm"), std::string::npos) << fine.out;

  Change("elbow_joint.theta", 4e-3);
  const std::string file = (folder_.path() / "check.json").string();
  const ProgramResult found = RunProgram(words + tables() + " --json " + file);
  EXPECT_EQ(found.exit_code, 4) << found.err;
  EXPECT_TRUE(found.out.starts_with("Moved: elbow_joint (elbow_joint.theta by 0.2")) << found.out;
  const nlohmann::json json = nlohmann::json::parse(ReadFile(file));
  EXPECT_EQ(json["status"], "moved");
  EXPECT_EQ(json["moved"][0]["joint"], "elbow_joint");
  EXPECT_TRUE(json["next_postures"].empty());

  const ProgramResult own = RunProgram(words + tables() + " -o " + file);
  EXPECT_EQ(own.exit_code, 3) << "the file is no posture file";
}

TEST_F(ArmProgram, DiagnosesTablesOfATrackerInSeveralFiles) {
  const std::string project = (folder_.path() / "project.yaml").string();
  const std::string out = (folder_.path() / "calibrated").string();
  const std::string tables = Table(q_.topRows(15), "a.csv").string() + " " +
                             Table(q_.bottomRows(15), "b.csv", 15).string();
  ASSERT_EQ(RunProgram("calibrate " + project + " --recording " + tables + " -o " + out).exit_code,
            0);
  const ProgramResult found = RunProgram("diagnose " + out + " --json -");
  ASSERT_EQ(found.exit_code, 0) << found.err;
  const nlohmann::json json = nlohmann::json::parse(found.out);
  EXPECT_EQ(json["postures"], kPostures);
  EXPECT_TRUE(json.contains("held_out_sds"));
  EXPECT_FALSE(json["candidates"].empty());
}

// A gear is a share. The turn of a sliding joint about its axis is not its offset.
TEST_F(ArmProgram, EstimatesHaveTheirUnits) {
  Eigen::MatrixXd shown = q_;
  shown.col(Coordinate("elbow_joint")) *= 0.997;
  const ProgramResult found =
      RunProgram("calibrate " + (folder_.path() / "project.yaml").string() + " --recording " +
                 Table(shown, "gear.csv").string() + " -o " + (folder_.path() / "gear").string());
  ASSERT_EQ(found.exit_code, 0) << found.err;
  const std::size_t gear = found.out.find("  elbow_joint.gear 0.3");
  ASSERT_NE(gear, std::string::npos) << found.out;
  const std::string line = found.out.substr(gear, found.out.find('\n', gear) - gear);
  EXPECT_TRUE(line.ends_with(" % (estimated)")) << line;
  EXPECT_EQ(found.out.find("rail_joint.theta"), std::string::npos) << found.out;
}

// A correction that `calibrate` was told to make is not named as a cause.
TEST_F(ArmProgram, DiagnosesWhatCalibrateCorrected) {
  const std::string project = (folder_.path() / "project.yaml").string();
  const auto diagnose = [&](const Eigen::MatrixXd& q, const std::string& name,
                            const std::string& words) {
    const std::string out = (folder_.path() / name).string();
    const std::string table = Table(q, name + ".csv").string();
    const ProgramResult calibrated =
        RunProgram("calibrate " + project + " --recording " + table + " -o " + out + words);
    EXPECT_EQ(calibrated.exit_code, 0) << calibrated.err;
    const ProgramResult found = RunProgram("diagnose " + out + " --json -");
    EXPECT_EQ(found.exit_code, 0) << found.err;
    return nlohmann::json::parse(found.out);
  };
  Eigen::MatrixXd reversed = q_;
  reversed.col(Coordinate("elbow_joint")) *= -1.0;
  const nlohmann::json sound = diagnose(q_, "sound", "");
  const nlohmann::json corrected = diagnose(reversed, "wrong", " --accept sign:elbow_joint");
  EXPECT_EQ(corrected["accepted"], false);
  EXPECT_NEAR(corrected["held_out_sds"], sound["held_out_sds"], 1e-9);

  const std::string prior = " --prior " + (folder_.path() / "sound").string();
  const nlohmann::json after = diagnose(q_, "again", prior);
  EXPECT_GT(std::abs(after["held_out_sds"].get<double>() - sound["held_out_sds"].get<double>()),
            1e-3);
}

TEST_F(Program, CheckTakesOneRecordingOfMarkers) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const ProgramResult two = RunProgram("check " + project_ + " --calibration " + out_ +
                                       " --recording " + recording_ + " " + recording_);
  EXPECT_EQ(two.exit_code, 3);
  EXPECT_NE(two.err.find("one was expected"), std::string::npos) << two.err;
}

}  // namespace
}  // namespace elastocal
