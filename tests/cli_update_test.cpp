// SPDX-License-Identifier: Apache-2.0
// The commands `calibrate --prior` and `design --after` as their users run them.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "elastocal/files/output_files.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/pipeline/earlier_calibration.hpp"
#include "tests/another_day.hpp"
#include "tests/program_fixture.hpp"

namespace elastocal {
namespace {

TEST_F(Program, APriorMakesAFewPosturesEnough) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const std::string today =
      AnotherDay(scratch_.path() / "today.csv", project_, truth_, "elbow_joint.theta", 5e-3);
  const std::string updated = (scratch_.path() / "updated").string();
  const ProgramResult result = RunProgram("calibrate " + project_ + " --recording " + today +
                                          " --prior " + out_ + " --days 2 --kfold 3 -o " + updated);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("elbow_joint: has moved since"), std::string::npos) << result.err;
  const auto offset = [](const std::string& folder) {
    const nlohmann::json json = nlohmann::json::parse(ReadFile(folder + "/summary.json"));
    for (const nlohmann::json& one : json["parameters"]) {
      if (one["name"] == "elbow_joint.theta") return one["value"].get<double>();
    }
    return std::nan("");
  };
  EXPECT_NEAR(offset(updated) - offset(out_), 5e-3, 5e-4);
  // The diagnosis uses the prior too: without it, these few postures leave another error.
  const std::string few = (scratch_.path() / "few").string();
  RunProgram("calibrate " + project_ + " --recording " + today + " --kfold 0 -o " + few);
  const auto left = [](const std::string& folder) {
    const ProgramResult found = RunProgram("diagnose " + folder + " --json -");
    EXPECT_EQ(found.exit_code, 0) << found.err;
    return nlohmann::json::parse(found.out)["held_out_mm"].get<double>();
  };
  EXPECT_LT(left(updated), 0.95 * left(few)) << left(few);
  const ProgramResult alone =
      RunProgram("calibrate " + project_ + " --recording " + today + " --days 2 -o " + updated);
  EXPECT_EQ(alone.exit_code, 2) << "--days without --prior";
}

// The name of the file does not matter, only what is in it.
TEST_F(Program, APriorFromTheSameRecordingCountsTwice) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const std::string copy = (scratch_.path() / "copy.csv").string();
  std::filesystem::copy_file(recording_, copy);
  const std::string today =
      AnotherDay(scratch_.path() / "today.csv", project_, truth_, "elbow_joint.theta", 0.0);
  const auto twice = [&](const std::string& recording) {
    const ProgramResult result =
        RunProgram("calibrate " + project_ + " --recording " + recording + " --prior " + out_ +
                   " --kfold 0 -o " + (scratch_.path() / "updated").string());
    return result.err.find("made from the same recording, which counts twice") != std::string::npos;
  };
  EXPECT_TRUE(twice(copy));
  EXPECT_TRUE(twice(recording_));
  EXPECT_FALSE(twice(today));
  std::filesystem::copy_file(today, recording_, std::filesystem::copy_options::overwrite_existing);
  EXPECT_FALSE(twice(recording_));
}

/// Makes an entry of a covariance larger than the variances allow.
void Damage(const std::filesystem::path& covariance, const std::string& a, const std::string& b) {
  std::istringstream file(ReadFile(covariance));
  std::string written, line;
  std::vector<std::string> names;
  for (std::getline(file, line); !line.empty(); line.clear(), std::getline(file, line)) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    if (names.empty()) names = cells;
    for (const auto& [of, other] : {std::pair(a, b), std::pair(b, a)}) {
      const auto column = std::ranges::find(names, other) - names.begin();
      if (cells.front() == of) cells[Size(column)] = "1";
    }
    for (std::size_t i = 0; i < cells.size(); ++i) written += (i > 0 ? "," : "") + cells[i];
    written += "\n";
  }
  WriteFile(covariance, written);
}

// This holds for covariances of markers too, which tell whether markers have stayed.
TEST_F(Program, AnEarlierCalibrationOfNoCovarianceIsRefused) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const std::string today =
      AnotherDay(scratch_.path() / "today.csv", project_, truth_, "elbow_joint.theta", 0.0);
  const std::string check =
      "check " + project_ + " --calibration " + out_ + " --recording " + today;
  const std::string update =
      "calibrate " + project_ + " --recording " + today + " --prior " + out_ + " -o " + out_ + "2";
  EXPECT_EQ(RunProgram(check).exit_code, 0);
  std::filesystem::remove(out_ + "/SHA256SUMS");
  Damage(out_ + "/covariance.csv", "marker.TOOL_1.x", "marker.TOOL_1.y");
  for (const std::string& words : {check, update}) {
    const ProgramResult refused = RunProgram(words);
    EXPECT_EQ(refused.exit_code, 3) << refused.err;
    EXPECT_NE(refused.err.find(out_), std::string::npos) << refused.err;
    EXPECT_NE(refused.err.find("not positive definite"), std::string::npos) << refused.err;
  }
  EXPECT_FALSE(std::filesystem::exists(out_ + "2"));
}

TEST_F(Program, AnUpdateThatPredictsWorseThanTheEarlierCalibrationSaysSo) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const std::string today =
      AnotherDay(scratch_.path() / "today.csv", project_, truth_, "elbow_joint.theta", 0.0);
  Project project = ReadProject(project_);
  Measurements measured = ReadMeasurements(project, {today}, ReadFor::kAnyUse);
  const RecordedModel robot = MakeRecordedModel(project, 1, measured);
  Recording& recording = measured.calibration;
  const auto said = [&](double updated, bool whole = true) {
    Eigen::MatrixXd distances(recording.posture_count(), recording.marker_count());
    distances.setConstant(updated);
    if (!whole) distances.col(0).setConstant(std::nan(""));
    return DescribeWorseUpdate(out_, robot, recording, project.calibration, distances);
  };
  EXPECT_EQ(said(1e-5), "");
  EXPECT_NE(said(1e-2).find("the update by 10 mm on those that were left out"), std::string::npos)
      << said(1e-2);
  // What was not held out does not count, however far off it is with the earlier calibration.
  for (int i = 0; i < recording.posture_count(); ++i) recording.markers(i, 0) += i % 2 * 0.2;
  EXPECT_EQ(said(1e-2), "");
  EXPECT_NE(said(1e-2, false), "");
  const ProgramResult update = RunProgram("calibrate " + project_ + " --recording " + today +
                                          " --prior " + out_ + " -o " + out_ + "2 --kfold 4");
  EXPECT_EQ(update.err.find("the update by"), std::string::npos) << update.err;
}

// The prior's errors refer to another frame of the root link.
TEST_F(Program, APriorWithAnotherGaugeIsRefused) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  std::string text = ReadFile(out_ + "/calibration.yaml");
  const std::size_t at = text.find("gauge: prior");
  ASSERT_NE(at, std::string::npos);
  std::filesystem::create_directory(scratch_.path() / "other");
  scratch_.Write("other/covariance.csv", ReadFile(out_ + "/covariance.csv"));
  scratch_.Write("other/calibration.yaml", text.replace(at, 12, "gauge: nominal_markers"));
  const std::string other = (scratch_.path() / "other").string();
  const std::string words = "calibrate " + project_ + " --recording " + recording_ + " --prior ";
  const ProgramResult refused = RunProgram(words + other + " -o " + out_ + "2");
  EXPECT_EQ(refused.exit_code, 3) << refused.err;
  for (const std::string& part : {other, std::string("'nominal_markers'"), std::string("'prior'"),
                                  std::string("calibration.gauge")}) {
    EXPECT_NE(refused.err.find(part), std::string::npos) << refused.err;
  }
  EXPECT_FALSE(std::filesystem::exists(out_ + "2"));
  EXPECT_EQ(RunProgram(words + out_ + " --kfold 0 -o " + out_ + "2").exit_code, 0);
}

// Markers on the bodies that carry a limb show the first joint of this limb.
TEST_F(Program, FollowUpsTellTheZerosThatCheckTells) {
  std::string text = ReadFile(project_);
  const std::string urdf = "arm6.urdf";
  text.replace(text.find(urdf), urdf.size(), SourceFile("tests/robots/arm6.urdf").string());
  const std::string project =
      scratch_.Write("designed.yaml", text + "design: {chains: [{chain: arm}]}\n");
  ASSERT_EQ(Calibrate(project, recording_).exit_code, 0);
  const std::string figures = (scratch_.path() / "d.json").string();
  const ProgramResult designed =
      RunProgram("design " + project + " --after " + out_ + " --check -o " +
                 (scratch_.path() / "p.yaml").string() + " --json " + figures);
  ASSERT_EQ(designed.exit_code, 0) << designed.err;
  const std::string today =
      AnotherDay(scratch_.path() / "today.csv", project, truth_, "elbow_joint.theta", 0.0);
  ASSERT_EQ(RunProgram("check " + project + " --calibration " + out_ + " --recording " + today +
                       " --json " + figures + "2")
                .exit_code,
            0);
  const auto not_told = nlohmann::json::parse(ReadFile(figures + "2"))["not_told"];
  const auto design = nlohmann::json::parse(ReadFile(figures));
  int told = 0;
  for (const auto& zero : design["chains"][0]["zeros"]) {
    const bool is_told = !zero["sd"].is_null();
    const bool by_check = std::ranges::count(not_told, zero["joint"]) == 0;
    EXPECT_TRUE(is_told || !by_check) << zero["joint"];
    told += is_told ? 1 : 0;
  }
  EXPECT_GE(told, 6);
}

TEST_F(Program, FollowUpsAreDesignedAndWrongOnesRefused) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const std::string no_design = RunProgram("design " + project_ + " --after " + out_ + " -o " +
                                           (scratch_.path() / "p.yaml").string())
                                    .err;
  EXPECT_NE(no_design.find("no section 'design'"), std::string::npos) << no_design;
  std::filesystem::remove(out_ + "/covariance.csv");
  const ProgramResult bare =
      RunProgram("check " + project_ + " --calibration " + out_ + " --recording " + recording_);
  EXPECT_EQ(bare.exit_code, 3);
  EXPECT_NE(bare.err.find("covariance.csv"), std::string::npos) << bare.err;
}

}  // namespace
}  // namespace elastocal
