// SPDX-License-Identifier: Apache-2.0
#include "elastocal/recorded/measurements.hpp"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <utility>

#include <gtest/gtest.h>

#include "elastocal/io/joint_log.hpp"
#include "elastocal/io/observation_table.hpp"
#include "elastocal/io/recording_folder.hpp"
#include "elastocal/readers/qtm_tsv.hpp"
#include "elastocal/validation/model_comparison.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"
#include "tests/trial_player.hpp"

namespace elastocal {
namespace {

class MeasurementsTest : public testing::Test {
 protected:
  void SetUp() override {
    const ScriptedTrial played =
        Play(MakeMarkedRobot(project_),
             {.postures = 8, .standing = FindLink(project_.tree, "right_sole")});
    WriteQtmTsv(folder_.path() / "a.tsv", played.markers);
    WriteJointLog(folder_.path() / "a.csv", played.log);
  }

  /// Writes an experiment with one trial of this kind.
  void WriteExperiment(const std::string& kind) const {
    folder_.Write("experiment.yaml",
                  "trials: [{name: check, kind: " + kind +
                      ", chain: left_leg, support: [right_sole], markers: a.tsv, joints: a.csv}]");
  }

  Project project_ = ReadProject(SourceFile("tests/robots/mini_humanoid_project.yaml"));
  ScratchFolder folder_;
};

// Estimating from the trials that were kept to judge the estimate would make the judgement
// worthless.
TEST_F(MeasurementsTest, ValidationTrialsAreNotEstimatedFrom) {
  WriteExperiment("random");
  ExpectInputError([&] { ReadMeasurements(project_, {folder_.path()}); },
                   {folder_.path().string(), "kind 'calibration'", "was expected"});
  const Measurements any = ReadMeasurements(project_, {folder_.path()}, ReadFor::kAnyUse);
  EXPECT_EQ(any.calibration.posture_count(), 8);
  EXPECT_EQ(any.validation.posture_count(), 0);
  WriteExperiment("calibration");
  EXPECT_EQ(ReadMeasurements(project_, {folder_.path()}).calibration.posture_count(), 8);
}

// Trials for validation are not judged beside those for calibration, and this is said.
TEST_F(MeasurementsTest, UnusedTrialsAreNamed) {
  for (const char* ending : {".tsv", ".csv"}) {
    std::filesystem::copy_file(folder_.path() / (std::string("a") + ending),
                               folder_.path() / (std::string("b") + ending));
  }
  const std::string trial = ", chain: left_leg, support: [right_sole], ";
  folder_.Write("experiment.yaml", "trials: [{name: one, kind: calibration" + trial +
                                       "markers: a.tsv, joints: a.csv}, {name: two, kind: random" +
                                       trial + "markers: b.tsv, joints: b.csv}]");
  const auto says = [&](ReadFor purpose) {
    const Measurements measured = ReadMeasurements(project_, {folder_.path()}, purpose);
    EXPECT_EQ(measured.calibration.posture_count(), 8);
    return std::ranges::any_of(measured.warnings, [](const std::string& warning) {
      return warning.starts_with("not used here: two, because beside trials of kind 'calibration'");
    });
  };
  EXPECT_TRUE(says(ReadFor::kAnyUse));
  EXPECT_FALSE(says(ReadFor::kCalibration));
}

// Each of the two recordings has its own order of markers.
TEST_F(MeasurementsTest, MarkersAreMatchedByName) {
  WriteExperiment("calibration");
  const Measurements whole = ReadMeasurements(project_, {folder_.path()});
  MarkerTrajectories fewer = ReadQtmTsv(folder_.path() / "a.tsv");
  const std::string left_out = whole.calibration.marker_names.front();
  const auto at = std::find(fewer.names.begin(), fewer.names.end(), left_out);
  ASSERT_NE(at, fewer.names.end());
  fewer.positions.middleCols<3>(3 * (at - fewer.names.begin()))
      .setConstant(std::numeric_limits<double>::quiet_NaN());
  WriteQtmTsv(folder_.path() / "b.tsv", fewer);
  std::filesystem::copy_file(folder_.path() / "a.csv", folder_.path() / "b.csv");
  const auto read = [&](const char* first, const char* second) {
    const std::string trial = ", chain: left_leg, support: [right_sole], markers: ";
    folder_.Write("experiment.yaml", "trials: [{name: one, kind: calibration" + trial + first +
                                         ".tsv, joints: " + first +
                                         ".csv}, {name: two, kind: random" + trial + second +
                                         ".tsv, joints: " + second + ".csv}]");
    return ReadMeasurements(project_, {folder_.path()});
  };
  for (const bool more_in_validation : {true, false}) {
    const Measurements measured = more_in_validation ? read("b", "a") : read("a", "b");
    ASSERT_EQ(measured.validation.marker_names, measured.calibration.marker_names);
    const bool known = !more_in_validation;
    const auto& names = measured.validation.marker_names;
    EXPECT_EQ(std::find(names.begin(), names.end(), left_out) != names.end(), known);
    for (std::size_t m = 0; m < names.size(); ++m) {
      const auto in_whole = std::find(whole.calibration.marker_names.begin(),
                                      whole.calibration.marker_names.end(), names[m]) -
                            whole.calibration.marker_names.begin();
      if (names[m] == left_out) {
        EXPECT_FALSE(Seen(measured.validation, 0, static_cast<int>(m)));
        continue;
      }
      EXPECT_LT((MarkerPosition(measured.validation, 0, static_cast<int>(m)) -
                 MarkerPosition(whole.calibration, 0, static_cast<int>(in_whole)))
                    .norm(),
                1e-3)
          << names[m];
    }
    const bool said = std::any_of(
        measured.warnings.begin(), measured.warnings.end(), [&](const std::string& warning) {
          return warning.find("for validation only") != std::string::npos &&
                 warning.find(left_out) != std::string::npos;
        });
    EXPECT_EQ(said, more_in_validation);
  }
}

// A fold leaves out postures that were recorded on one day.
TEST_F(MeasurementsTest, EachFolderIsASession) {
  WriteExperiment("calibration");
  const ScratchFolder other;
  std::filesystem::copy(folder_.path(), other.path(), std::filesystem::copy_options::recursive);
  other.Write(
      "experiment.yaml",
      "trials: [{name: one, chain: left_leg, support: [right_sole], markers: a.tsv, joints: "
      "a.csv}, {name: two, chain: left_leg, support: [right_sole], markers: b.tsv, joints: "
      "b.csv}]");
  for (const char* name : {"tsv", "csv"}) {
    const std::string file = std::string(".") + name;
    std::filesystem::copy_file(other.path() / ("a" + file), other.path() / ("b" + file));
  }
  const Recording both = ReadMeasurements(project_, {folder_.path(), other.path()}).calibration;
  ASSERT_EQ(both.posture_count(), 24);
  const std::vector<int> fold = DealFolds(both, {.folds = 2, .unit = FoldUnit::kSession});
  for (int i = 0; i < 24; ++i) EXPECT_EQ(fold[i] == fold[0], i < 8) << i;
  ExpectInputError([&] { DealFolds(both, {.folds = 3, .unit = FoldUnit::kSession}); },
                   {"2 to 2 folds", "recording folders", "not 3"});
  EXPECT_NO_THROW(DealFolds(both, {.folds = 3, .unit = FoldUnit::kTrial}));
}

// Two days of one robot may have trials with the same names.
TEST_F(MeasurementsTest, TheTruthOfATrialIsThatOfItsOwnFolder) {
  const ScratchFolder other;
  std::filesystem::copy(folder_.path(), other.path(), std::filesystem::copy_options::recursive);
  for (const ScratchFolder* folder : {&other, &std::as_const(folder_)}) {
    folder->Write("experiment.yaml",
                  "trials: [{name: check, chain: left_leg, support: [right_sole], markers: a.tsv, "
                  "joints: a.csv, truth: waist.csv}]");
    folder->Write("waist.csv", std::string("t,x,y,z,qw,qx,qy,qz\n0,") +
                                   (folder == &other ? "2" : "1") + ",0,0,1,0,0,0\n");
  }
  const Measurements both = ReadMeasurements(project_, {folder_.path(), other.path()});
  ASSERT_EQ(both.calibration_truth.size(), 16u);
  for (std::size_t i = 0; i < 16; ++i) {
    ASSERT_TRUE(both.calibration_truth[i]);
    EXPECT_EQ(both.calibration_truth[i]->translation().x(), i < 8 ? 1.0 : 2.0);
  }
}

// The kinds of trials do not tell their order in time.
TEST_F(MeasurementsTest, FeetRestInTheOrderOfTheTrials) {
  std::string trials;
  for (const auto& [name, kind] : std::map<std::string, std::string>{
           {"one", "calibration"}, {"other", "random"}, {"third", "calibration"}}) {
    for (const std::string type : {".tsv", ".csv"}) {
      std::filesystem::copy_file(folder_.path() / ("a" + type), folder_.path() / (name + type));
    }
    trials += (trials.empty() ? "" : ", ") + ("{name: " + name + ", kind: " + kind) +
              ", chain: left_leg, support: [right_sole], markers: " + name +
              ".tsv, joints: " + name + ".csv}";
  }
  folder_.Write("experiment.yaml", "trials: [" + trials + "]");
  std::vector<int> order;
  for (const FootRest& foot : ReadMeasurements(project_, {folder_.path()}).foot_rests) {
    order.push_back(foot.trial);
  }
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2}));
}

TEST_F(MeasurementsTest, AJointThatNoLogHasIsNotRecorded) {
  WriteExperiment("calibration");
  JointLog log = ReadJointLog(folder_.path() / "a.csv", project_);
  ASSERT_EQ(log.names.front(), "head_yaw");
  log.names.erase(log.names.begin());
  log.positions = log.positions.rightCols(log.positions.cols() - 1).eval();
  log.torques.resize(log.positions.rows(), 0);
  WriteJointLog(folder_.path() / "a.csv", log);
  project_.recording.not_recorded = {{"head_yaw", 0.1}, {log.names.front(), 0.2}};
  const Recording recording = ReadMeasurements(project_, {folder_.path()}).calibration;
  EXPECT_EQ(recording.joints_not_recorded, std::vector<std::string>{"head_yaw"});
}

TEST_F(MeasurementsTest, ListsEveryFileThatIsRead) {
  WriteExperiment("calibration");
  const auto files = InputFiles(project_, {folder_.path(), "table.csv"});
  for (const auto& file :
       {project_.file, project_.urdf, folder_.path() / "experiment.yaml", folder_.path() / "a.tsv",
        folder_.path() / "a.csv", std::filesystem::path("table.csv")}) {
    EXPECT_NE(std::find(files.begin(), files.end(), file), files.end()) << file;
  }
  EXPECT_EQ(files.size(), 6u);
}

TEST(ObservationFiles, AFolderThatSimulateWroteStandsForItsTables) {
  const ScratchFolder scratch;
  for (const char* name : {"full", "other"}) {
    std::filesystem::create_directory(scratch.path() / name);
  }
  const std::filesystem::path table = scratch.Write("full/observations.csv", "a\n");
  const std::filesystem::path folder = table.parent_path();
  using Files = std::vector<std::filesystem::path>;
  EXPECT_EQ(ObservationFiles({"b.csv", folder}), (Files{"b.csv", table}));
  const std::filesystem::path corners = scratch.Write("full/corners.csv", "b\n");
  EXPECT_EQ(ObservationFiles({folder}), (Files{table, corners}));
  scratch.Write("other/truth.yaml", "");
  ExpectInputError([&] { ObservationFiles({scratch.path() / "other"}); },
                   {"other: this is a folder without observations.csv"});
}

TEST_F(MeasurementsTest, OnlyFoldersCanBeTakenTogether) {
  ExpectInputError(
      [&] {
        ReadMeasurements(project_, {"a.csv", "b.csv"});
      },
      {"b.csv", "no experiment.yaml"});
  ExpectInputError([&] { ReadMeasurements(project_, {}); }, {"no recording"});
  const ScratchFolder empty;
  ExpectInputError([&] { InputFiles(project_, {empty.path()}); },
                   {empty.path().string(), "no experiment.yaml in this folder", "posture table"});
  empty.Write("metadata.yaml", "");
  ExpectInputError([&] { InputFiles(project_, {empty.path()}); },
                   {empty.path().string(), "ROS bag", "needs a folder with experiment.yaml"});
}

}  // namespace
}  // namespace elastocal
