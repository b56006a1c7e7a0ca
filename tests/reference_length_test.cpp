// SPDX-License-Identifier: Apache-2.0
// MuJoCo's arm from files, with cameras of a wrong scale, which a bar of known length reveals.

#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "elastocal/elastocal.hpp"
#include "elastocal/files/output_files.hpp"
#include "elastocal/planning/simulate_experiment.hpp"
#include "elastocal/readers/qtm_tsv.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

class ReferenceLengths : public ::testing::Test {
 protected:
  ReferenceLengths() {
    Project project = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
    project.recording.reference_lengths = {{{"BAR_1", "BAR_2"}, 0.5, 5e-5}};
    project_ = std::move(project);
    SimulationOptions options;
    options.experiment.seed = 4;
    SimulateExperiment(project_, options, scratch_.path());
  }

  /// Multiplies all positions in the files of one trial, or of all, by `factor`.
  void Scale(double factor, const std::string& only = "") {
    for (const auto& entry : std::filesystem::directory_iterator(scratch_.path())) {
      if (entry.path().extension() != ".tsv") continue;
      if (!only.empty() && entry.path().stem() != only) continue;
      MarkerTrajectories markers = ReadQtmTsv(entry.path());
      markers.positions *= factor;
      WriteQtmTsv(entry.path(), markers);
    }
  }

  CalibrationRun Calibrated(const std::vector<std::string>& accept = {}) {
    return CalibrateExperiment(project_, {scratch_.path()}, {.folds = 0, .accept = accept});
  }

  static std::string Objections(const CalibrationRun& run) {
    std::string all;
    for (const std::string& objection : run.verdict.objections) all += objection + "\n";
    return all;
  }

  ScratchFolder scratch_;
  Project project_;
};

TEST_F(ReferenceLengths, OfGoodCamerasAreNoObjectionAndNoMarkersOfTheRobot) {
  const CalibrationRun run = Calibrated();
  EXPECT_TRUE(run.deployable()) << Objections(run);
  for (const TrialSummary& trial : run.trials) {
    ASSERT_TRUE(trial.scale) << trial.trial.name;
    EXPECT_NEAR(trial.scale->size, 0.0, 4.0 * trial.scale->sd);
    EXPECT_TRUE(trial.markers_unknown.empty());
    EXPECT_NE(Describe(trial).find("; scale of the cameras "), std::string::npos);
  }
}

TEST_F(ReferenceLengths, ShowAScaleThatTheRobotsOwnLengthsDoNot) {
  const CalibrationRun clean = Calibrated();
  Scale(1.002);
  project_.recording.reference_lengths.clear();
  EXPECT_TRUE(Calibrated().deployable()) << "what the bar is for";
  project_.recording.reference_lengths = {{{"BAR_1", "BAR_2"}, 0.5, 5e-5}};
  const CalibrationRun run = Calibrated();
  EXPECT_FALSE(run.deployable());
  const std::string said = Objections(run);
  EXPECT_NE(said.find("times the true ones in all trials"), std::string::npos) << said;
  const std::size_t name = said.find("--accept scale=1.00");
  ASSERT_NE(name, std::string::npos) << said;
  const std::string accept = said.substr(name + 9, said.find(' ', name + 9) - name - 9);

  const CalibrationRun corrected = Calibrated({accept});
  EXPECT_TRUE(corrected.deployable()) << Objections(corrected);
  const Eigen::VectorXd& delta = corrected.comparison.largest().delta;
  const Eigen::VectorXd& of_clean = clean.comparison.largest().delta;
  ASSERT_EQ(delta.size(), of_clean.size());
  EXPECT_LT((delta - of_clean).cwiseAbs().maxCoeff(), 4e-4) << "m, rad: 1e-4 of its lengths";
}

TEST_F(ReferenceLengths, NameTheTrialWhoseScaleIsWrong) {
  const std::string trial = Calibrated().trials.front().trial.name;
  Scale(0.997, trial);
  const std::string said = Objections(Calibrated());
  EXPECT_NE(said.find("in trial " + trial + " (--accept scale:" + trial + "=0.99"),
            std::string::npos)
      << said;
}

TEST_F(ReferenceLengths, NameEachFactorOfTrialsThatDiffer) {
  const std::vector<TrialSummary> trials = Calibrated().trials;
  ASSERT_GE(trials.size(), 2u);
  const std::string first = trials[0].trial.name, second = trials[1].trial.name;
  Scale(0.997, first);
  Scale(1.004, second);
  const std::string said = Objections(Calibrated());
  EXPECT_NE(said.find("positions are 0.99"), std::string::npos) << said;
  EXPECT_NE(said.find("times the true ones in trial " + first + ", 1.00"), std::string::npos)
      << said;
  EXPECT_NE(said.find("times in trial " + second + " (--accept scale:" + first + "=0.99"),
            std::string::npos)
      << said;
}

TEST_F(ReferenceLengths, ThatAreNotSeenAreSaidToBe) {
  project_.recording.reference_lengths = {{{"BAR_1", "BAR_3"}, 0.5, 5e-5}};
  const CalibrationRun run = Calibrated();
  EXPECT_TRUE(run.deployable());
  bool said = false;
  for (const std::string& warning : run.warnings) {
    said = said || warning.find("no reference length") != std::string::npos;
  }
  EXPECT_TRUE(said);
}

}  // namespace
}  // namespace elastocal
