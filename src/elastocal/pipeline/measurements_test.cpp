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
    for (const char* name : {"a", "b"}) {
      WriteQtmTsv(folder_.path() / (std::string(name) + ".tsv"), played.markers);
      WriteJointLog(folder_.path() / (std::string(name) + ".csv"), played.log);
    }
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

// A trial for validation may show markers that none for calibration shows (its trial was refused,
// as one in which the clock cannot be told), and the other way round.
TEST_F(MeasurementsTest, ValidationHasTheMarkersOfTheEstimate) {
  const auto read = [&](const std::string& calibration, const std::string& validation) {
    const std::string rest = ", support: [right_sole], markers: ";
    folder_.Write("experiment.yaml", "trials:\n  - {name: fit, chains: [" + calibration + "]" +
                                         rest + "a.tsv, joints: a.csv}\n" +
                                         "  - {name: judge, kind: random, chains: [" + validation +
                                         "]" + rest + "b.tsv, joints: b.csv}\n");
    return ReadMeasurements(project_, {folder_.path()});
  };
  const Measurements more = read("left_leg", "left_leg, head");
  EXPECT_EQ(more.validation.marker_names, more.calibration.marker_names);
  // The same motion, of whose rests other frames may have been taken: 0.2 mm of noise.
  constexpr double kTolerance = 1e-3;
  EXPECT_LT((more.validation.markers - more.calibration.markers).cwiseAbs().maxCoeff(), kTolerance);
  const Measurements fewer = read("left_leg, head", "left_leg");
  ASSERT_EQ(fewer.validation.marker_names, fewer.calibration.marker_names);
  for (int m = 0; m < fewer.validation.marker_count(); ++m) {
    if (fewer.validation.marker_names[m].starts_with("HEAD")) {
      EXPECT_FALSE(Seen(fewer.validation, 0, m));
    } else {
      EXPECT_LT(
          (MarkerPosition(fewer.validation, 0, m) - MarkerPosition(fewer.calibration, 0, m)).norm(),
          kTolerance);
    }
  }
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
