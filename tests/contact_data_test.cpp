// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "elastocal/io/observation_table.hpp"
#include "elastocal/pipeline/contact_check.hpp"
#include "elastocal/pipeline/contact_run.hpp"
#include "elastocal/tables/read_file.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

// Touches of a real TALOS: a flat gripper on a table, with both feet on the floor.

constexpr double kDegree = M_PI / 180.0;

class TalosTable : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* side : {"left", "right"}) {
      files_.push_back(SharedFile(std::string("data/talos_table_contact/") + side + ".csv"));
      if (!std::filesystem::exists(files_.back())) GTEST_SKIP() << "no " << files_.back();
    }
    project_ = ReadProject(SourceFile("examples/talos_table/project.yaml"));
  }

  std::vector<std::filesystem::path> files_;
  Project project_;
};

/// Compliance of the hip pitch joints and its standard deviation, degrees per 100 N.m.
std::pair<double, double> Hip(const ContactRun& run) {
  const int hip = FindParameter(run.result.model.parameters, "leg_left_3_joint.compliance_z");
  return {100.0 / kDegree * run.result.delta[hip], 100.0 / kDegree * run.result.sd[hip]};
}

TEST_F(TalosTable, TouchesThatAreLeftOutArePredicted) {
  ContactRun run = CalibrateContacts(project_, files_, {.folds = 50, .threads = 2});
  ASSERT_EQ(run.observations.count(), 50);
  EXPECT_TRUE(run.deployable());
  const ObservationFigures& figures = run.calibrated.held_out.figures;
  // The figures are those of docs/accuracy.md. Differences below 1 % may come from rounding.
  EXPECT_NEAR(1e3 * figures.all.height, 3.06, 0.03);
  EXPECT_NEAR(figures.all.tilt() / kDegree, 0.274, 0.003);
  EXPECT_EQ(figures.by_plate[0].touches, 21);
  EXPECT_EQ(figures.by_plate[1].touches, 29);
  EXPECT_GT(1e3 * run.uncalibrated.held_out.figures.all.height, 12.0);
  EXPECT_NEAR(Hip(run).first, 2.01, 0.02);
  EXPECT_TRUE(run.closure.planned());
  EXPECT_EQ(run.observations.effects.size(), 9u);

  const auto summary = nlohmann::json::parse(MakeContactSummary(run));
  EXPECT_DOUBLE_EQ(summary["contact"]["kfold"]["height_mm"].get<double>(),
                   1e3 * figures.all.height);
  EXPECT_EQ(summary["contact"]["kfold"]["by_side"]["right"]["touches"], 29);
  EXPECT_EQ(summary["contact"]["kfold"]["of_touches"].size(), 50u);
}

TEST_F(TalosTable, TheEncodersTellTheStartsOfTheRobot) {
  const ObservationTables by_counts = ReadObservationTables(files_, project_);
  project_.contact->sessions = {};
  project_.contact->sessions.from_encoders = true;
  for (const char* gripper : {"gripper_left_joint", "gripper_right_joint"}) {
    project_.recording.ignore.emplace_back(gripper);
  }
  const ObservationTables found = ReadObservationTables(files_, project_);
  ASSERT_EQ(found.observations.effects.size(), 9u);
  for (int i = 0; i < found.observations.count(); ++i) {
    EXPECT_EQ(found.observations.all[i].effects, by_counts.observations.all[i].effects) << i;
  }
  ASSERT_EQ(found.warnings.size(), 2u);
  EXPECT_NE(found.warnings[0].find("5 starts of the robot"), std::string::npos)
      << found.warnings[0];
  EXPECT_NE(found.warnings[1].find("4 starts of the robot"), std::string::npos)
      << found.warnings[1];
}

TEST_F(TalosTable, EachSideAloneFindsTheComplianceOfTheHips) {
  for (const std::filesystem::path& file : files_) {
    const auto [value, sd] = Hip(CalibrateContacts(project_, {file}, {.folds = 0}));
    EXPECT_GT(value + 2.0 * sd, 2.0) << file;
    EXPECT_LT(value - 2.0 * sd, 2.3) << file;
    EXPECT_LT(sd, 0.2) << file;
  }
}

// Every fourth touch stands for another day.
TEST_F(TalosTable, AFewTouchesTellTheJointThatMoved) {
  const ScratchFolder folder;
  const std::string kElbow = "arm_right_4_joint";
  // `only`: the single row of the right hand in which the joint is off, or -1 for all rows.
  const auto write = [&](bool other, const std::string& joint, double by, int only = -1) {
    std::vector<std::filesystem::path> tables;
    for (const std::filesystem::path& file : files_) {
      std::istringstream all(ReadFile(file));
      std::string text, line;
      int column = 0, touches = 0;
      for (int number = 0; std::getline(all, line); ++number) {
        std::istringstream row(line);
        std::vector<std::string> cells;
        for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
        if (number == 0) {
          column = static_cast<int>(std::find(cells.begin(), cells.end(), joint) - cells.begin());
        } else if ((number % 4 == 0) != other) {
          continue;
        } else {
          const bool off = only < 0 || (touches == only && file == files_[1]);
          cells[column] = fmt::format("{:.12g}", std::stod(cells[column]) + (off ? by : 0.0));
          ++touches;
        }
        text += fmt::format("{}\n", fmt::join(cells, ","));
      }
      tables.push_back(folder.path() / ((other ? "then_" : "") + file.filename().string()));
      std::ofstream(tables.back()) << text;
    }
    return tables;
  };
  ContactRun run = CalibrateContacts(project_, write(false, kElbow, 0.0), {.folds = 0});
  const std::filesystem::path out = folder.path() / "out";
  std::filesystem::create_directory(out);
  for (const auto& [name, text] : MakeContactFiles(project_, run)) {
    std::ofstream(out / name) << text;
  }
  EXPECT_EQ(CheckStatus(CheckContacts(project_, out, write(true, kElbow, 0.0))), "unchanged");
  const ContactCheck moved = CheckContacts(project_, out, write(true, kElbow, 2.0 * kDegree));
  EXPECT_EQ(CheckStatus(moved), "moved");
  ASSERT_EQ(moved.check.moved.size(), 1u);
  EXPECT_EQ(moved.check.moved[0].joint, "arm_right_4_joint");
  EXPECT_NEAR(moved.check.moved[0].changes[0].value, -2.0 * kDegree, 0.5 * kDegree);
  // One touch contributes more than the others. That the touch is wrong is still less likely.
  const ContactCheck shoulder =
      CheckContacts(project_, out, write(true, "arm_left_1_joint", 2.0 * kDegree));
  EXPECT_EQ(CheckStatus(shoulder), "moved");
  EXPECT_EQ(shoulder.check.moved.front().joint, "arm_left_1_joint");
  // A wrist is off in one touch only.
  const ContactCheck one =
      CheckContacts(project_, out, write(true, "arm_right_6_joint", 3.0 * kDegree, 1));
  EXPECT_TRUE(one.check.changed());
  EXPECT_EQ(CheckStatus(one), "recording wrong");
  ASSERT_FALSE(one.alternatives.empty());
  EXPECT_NE(one.alternatives[0].find("right.csv:3: this posture alone"), std::string::npos)
      << one.alternatives[0];
}

TEST_F(TalosTable, ATouchInTheAirIsNamed) {
  ContactRun run = CalibrateContacts(project_, files_, {.folds = 0});
  Observations touches = run.observations;
  const int elbow = FindJoint(project_.tree, "arm_right_4_joint");
  touches.q(30, project_.tree.joints[elbow].coordinate) -= 0.3;
  run.calibrated.estimate = EstimateObserved(run.model, touches, {});
  const std::vector<std::string> texts =
      DescribeOutliers(run.model, run.observations, run.calibrated.estimate);
  ASSERT_EQ(texts.size(), 1u);
  EXPECT_NE(texts[0].find("right.csv:11: "), std::string::npos) << texts[0];
}

}  // namespace
}  // namespace elastocal
