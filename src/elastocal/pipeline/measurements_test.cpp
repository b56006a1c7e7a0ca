#include "elastocal/pipeline/measurements.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "elastocal/io/joint_log.hpp"
#include "elastocal/io/qtm_tsv.hpp"
#include "elastocal/io/recording_folder.hpp"
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

  /// One trial of this kind.
  void WriteExperiment(const std::string& kind) const {
    folder_.Write("experiment.yaml",
                  "trials: [{name: check, kind: " + kind +
                      ", chain: left_leg, support: [right_sole], markers: a.tsv, joints: a.csv}]");
  }

  Project project_ = ReadProject(SourceFile("tests/robots/mini_humanoid_project.yaml"));
  ScratchFolder folder_;
};

// To estimate from what was kept for judging the estimates would make the judgement worthless.
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

TEST_F(MeasurementsTest, OnlyFoldersCanBeTakenTogether) {
  ExpectInputError(
      [&] {
        ReadMeasurements(project_, {"a.csv", "b.csv"});
      },
      {"b.csv", "no experiment.yaml"});
  ExpectInputError([&] { ReadMeasurements(project_, {}); }, {"no recording"});
}

}  // namespace
}  // namespace elastocal
