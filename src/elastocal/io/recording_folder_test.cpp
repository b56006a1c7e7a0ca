// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/recording_folder.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/files/output_files.hpp"
#include "elastocal/io/joint_log.hpp"
#include "elastocal/readers/qtm_tsv.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/recording_writers.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"
#include "tests/trial_player.hpp"

namespace elastocal {
namespace {

constexpr char kTwoTrials[] =
    "trials:\n"
    "  - {name: swing, chain: left_leg, support: [right_sole], markers: a.tsv, joints: a.csv}\n"
    "  - {name: check, kind: random, chains: [left_arm, head], support: [right_sole],\n"
    "     markers: b.tsv, joints: b.csv}\n";

class RecordingFolderTest : public testing::Test {
 protected:
  /// Plays a trial and writes it to the files NAME.tsv and NAME.csv of the folder.
  ScriptedTrial Write(const std::string& name, PlayOptions options) const {
    options.standing = FindLink(project_.tree, "right_sole");
    ScriptedTrial played = Play(MakeMarkedRobot(project_), options);
    WriteQtmTsv(folder_.path() / (name + ".tsv"), played.markers);
    WriteJointLog(folder_.path() / (name + ".csv"), played.log);
    return played;
  }

  RecordingFolder Read(const std::string& experiment = kTwoTrials) const {
    folder_.Write("experiment.yaml", experiment);
    return ReadRecordingFolders({folder_.path()}, project_);
  }

  Project project_ = ReadProject(SourceFile("tests/robots/mini_humanoid_project.yaml"));
  ScratchFolder folder_;
};

// The position of the marker by the sampled joint positions, in the frame of the player's cameras.
Eigen::Vector3d Expected(const Project& project, const Recording& recording, int posture, int m) {
  const Eigen::VectorXd positions = PlayedPositions(
      MakeMarkedRobot(project), FindLink(project.tree, "right_sole"), recording.q.row(posture));
  for (std::size_t i = 0; i < project.markers.size(); ++i) {
    if (project.markers[i].name == recording.marker_names[m]) return positions.segment<3>(3 * i);
  }
  throw std::logic_error("no such marker");
}

TEST_F(RecordingFolderTest, CorrectsNoLabelsOfPairs) {
  const std::size_t before = MakeMarkedRobot(project_).clusters.size();
  EXPECT_EQ(before, project_.clusters.size());
  Marker one = project_.markers.front();
  for (const char* name : {"P", "Q"}) {
    one.name = name;
    project_.markers.push_back(one);
  }
  EXPECT_EQ(MakeMarkedRobot(project_).clusters.size(), before);
  one.name = "R";
  project_.markers.push_back(one);
  EXPECT_EQ(MakeMarkedRobot(project_).clusters.size(), before + 1);
}

TEST_F(RecordingFolderTest, KeepsValidationApart) {
  project_.torque_sensors = {FindJoint(project_.tree, "left_knee_pitch")};
  Write("a", {.postures = 12, .lag_s = 3.0});
  Write("b", {.postures = 8, .lag_s = -2.0, .seed = 5});
  const RecordingFolder folder = Read();
  EXPECT_TRUE(folder.findings.empty()) << folder.findings.front();
  ASSERT_EQ(folder.calibration.posture_count(), 12);
  ASSERT_EQ(folder.validation.posture_count(), 8);
  EXPECT_EQ(folder.calibration.trials[0].name, "swing");
  EXPECT_EQ(folder.calibration.trials[0].chains, std::vector<std::string>{"left_leg"});
  EXPECT_EQ(folder.validation.trials[0].kind, TrialKind::kRandom);
  EXPECT_EQ(folder.validation.trials[0].support.size(), 1u);
  EXPECT_EQ(folder.calibration.gravity, Eigen::Vector3d(0, 0, -9.81));
  ASSERT_EQ(folder.trials.size(), 2u);
  EXPECT_NEAR(folder.trials[0].clock.lag_s, 3.0, 2e-3);
  EXPECT_NEAR(folder.trials[1].clock.lag_s, -2.0, 2e-3);
  EXPECT_EQ(folder.trials[0].samples, 96);
  const Recording& recording = folder.calibration;
  for (int i = 0; i < recording.posture_count(); ++i) {
    for (int m = 0; m < recording.marker_count(); ++m) {
      EXPECT_LT((MarkerPosition(recording, i, m) - Expected(project_, recording, i, m)).norm(),
                0.5e-3);
    }
  }
  // The recording has torques only for the sensor of the project.
  for (Eigen::Index k = 0; k < recording.torques.cols(); ++k) {
    EXPECT_EQ(recording.torques.col(k).allFinite(), k == project_.torque_sensors[0]);
  }
}

TEST_F(RecordingFolderTest, TakesTheMarkersThatBelongToATrial) {
  const auto names = [&](const std::vector<int>& chains, const std::vector<int>& support) {
    TrialFiles trial;
    trial.chains = chains;
    trial.support = support;
    std::vector<std::string> clusters;
    for (const int m : TrialMarkers(project_, trial)) {
      const std::string& name = project_.markers[m].name;
      clusters.push_back(name.substr(0, name.size() - 2));
    }
    clusters.erase(std::unique(clusters.begin(), clusters.end()), clusters.end());
    return clusters;
  };
  const int right_sole = FindLink(project_.tree, "right_sole");
  EXPECT_EQ(names({3}, {right_sole}), (std::vector<std::string>{"BACK", "LFOOT", "RFOOT"}));
  EXPECT_EQ(names({0, 1}, {}), (std::vector<std::string>{"BACK", "HEAD", "LHAND"}));
}

/// If the lag of a clock cannot be told, every mistake of a log is tried.
using RecordingFolderStudy = RecordingFolderTest;

TEST_F(RecordingFolderStudy, GoesOnWithoutATrialThatItRefuses) {
  Write("a", {.postures = 12});
  Write("b", {.postures = 8});
  Write("c", {.postures = 8, .seed = 99});
  std::filesystem::copy_file(folder_.path() / "c.csv", folder_.path() / "b.csv",
                             std::filesystem::copy_options::overwrite_existing);
  const RecordingFolder folder = Read();
  EXPECT_EQ(folder.calibration.posture_count(), 12);
  EXPECT_EQ(folder.validation.posture_count(), 0);
  ASSERT_EQ(folder.findings.size(), 2u);  // the other one is of torques
  EXPECT_NE(folder.findings[0].find("trial check: not used: "), std::string::npos);

  ExpectInputError(
      [&] {
        Read(
            "trials: [{name: x, chain: left_arm, support: [right_sole], markers: b.tsv, "
            "joints: b.csv}]");
      },
      {folder_.path().string(), "no trial can be used", "trial x: not used: "});
}

TEST_F(RecordingFolderTest, MergesFolders) {
  Write("a", {.postures = 12});
  Write("b", {.postures = 8, .seed = 5});
  Read();
  const std::filesystem::path other = folder_.path() / "second";
  std::filesystem::create_directory(other);
  for (const char* file : {"a.tsv", "a.csv", "b.tsv", "b.csv", "experiment.yaml"}) {
    std::filesystem::copy_file(folder_.path() / file, other / file);
  }
  const RecordingFolder folder = ReadRecordingFolders({folder_.path(), other}, project_);
  EXPECT_EQ(folder.calibration.posture_count(), 24);
  EXPECT_EQ(folder.calibration.trials.size(), 2u);
  EXPECT_EQ(folder.calibration.trials[1].name, "second/swing");
  EXPECT_EQ(folder.calibration.trial[12], 1);
  ExpectInputError(
      [&] {
        ReadRecordingFolders({other, other}, project_);
      },
      {"'second/swing'", "given twice"});
  WriteFile(other / "experiment.yaml", std::string("up: y\n") + kTwoTrials);
  ExpectInputError(
      [&] {
        ReadRecordingFolders({folder_.path(), other}, project_);
      },
      {folder_.path().string(), "a.tsv", "the axis z points up"});
  WriteFile(folder_.path() / "experiment.yaml", std::string("up: x\n") + kTwoTrials);
  ExpectInputError(
      [&] {
        ReadRecordingFolders({folder_.path(), other}, project_);
      },
      {other.string(), "another axis up"});
}

// The files of one folder say which axis points up, and experiment.yaml of the other one says it.
TEST_F(RecordingFolderTest, FoldersMayStateTheAxisInTheirOwnWays) {
  ScriptedTrial played = Write("a", {.postures = 12});
  Write("b", {.postures = 8, .seed = 5});
  const std::string z = "up: z\n" + std::string(kTwoTrials);
  folder_.Write("experiment.yaml", kTwoTrials);
  const std::filesystem::path other = folder_.path() / "second";
  std::filesystem::create_directory(other);
  for (const char* name : {"a", "b"}) {
    const std::string file = name;
    const MarkerTrajectories markers = ReadQtmTsv(folder_.path() / (file + ".tsv"));
    WriteFile(other / (file + ".trc"), TrcText(markers));  // it states no axis
    std::filesystem::copy_file(folder_.path() / (file + ".csv"), other / (file + ".csv"));
  }
  std::string experiment = z;
  for (std::size_t at = 0; (at = experiment.find(".tsv", at)) != std::string::npos;) {
    experiment.replace(at, 4, ".trc");
  }
  WriteFile(other / "experiment.yaml", experiment);
  const RecordingFolder folder = ReadRecordingFolders({folder_.path(), other}, project_);
  EXPECT_EQ(folder.calibration.posture_count(), 24);
  EXPECT_EQ(folder.calibration.gravity, Eigen::Vector3d(0, 0, -9.81));
}

// The usual first mistake: the cameras' labels are not the names of the project.
TEST_F(RecordingFolderTest, SaysWhichLabelsWereExpected) {
  ScriptedTrial played = Write("a", {.postures = 4});
  Write("b", {.postures = 4});
  std::string first;
  for (const char* name : {"a", "b"}) {
    const std::filesystem::path file = folder_.path() / (std::string(name) + ".tsv");
    MarkerTrajectories markers = ReadQtmTsv(file);
    for (std::string& label : markers.names) {
      for (char& c : label) c = std::islower(c) != 0 ? std::toupper(c) : std::tolower(c);
    }
    first = *std::ranges::min_element(markers.names);
    WriteQtmTsv(file, markers);
  }
  ExpectInputError([&] { Read(); },
                   {"none of its markers is in the marker file, whose labels are '", first,
                    "expected were '", "(is it '", "recording.labels"});
}

TEST_F(RecordingFolderTest, RefusesALabelThatOccursTwice) {
  ScriptedTrial played = Write("a", {.postures = 4});
  Write("b", {.postures = 4});
  const std::string label = project_.markers.front().name;
  played.markers.names.back() = label + "#2";  // as readers call it
  WriteQtmTsv(folder_.path() / "a.tsv", played.markers);
  ExpectInputError([&] { Read(); }, {"a.tsv", "two trajectories have the label", label});
}

TEST_F(RecordingFolderTest, NamesTorquesThatNoSensorIsListedFor) {
  Write("a", {.postures = 12});
  Write("b", {.postures = 8});
  const auto notes = [&] {
    const std::vector<std::string> findings = Read().findings;
    return std::ranges::count_if(findings, [](const std::string& finding) {
      return finding.starts_with("torques of ") &&
             finding.find("no torque_sensors") != std::string::npos;
    });
  };
  EXPECT_EQ(notes(), 1);
  project_.elasticity.torsion = std::vector<std::string>();
  EXPECT_EQ(notes(), 0) << "a rigid robot needs no loads";
  project_.elasticity.torsion.reset();
  project_.torque_sensors = {FindJoint(project_.tree, "left_knee_pitch")};
  EXPECT_EQ(notes(), 0);
  project_.torque_sensors.clear();
  folder_.Write("truth.yaml", "trials: {}\n");
  EXPECT_EQ(notes(), 0) << "a simulation";
}

TEST_F(RecordingFolderStudy, KnowsWhichAxisIsUpAndWhatLagToExpect) {
  Write("a", {.postures = 12, .lag_s = 1000.0});
  Write("b", {.postures = 8});
  const std::string trials = kTwoTrials;
  const RecordingFolder folder =
      Read("up: y\n" + trials.substr(0, trials.find("markers: a")) + "expected_lag_s: 998, " +
           trials.substr(trials.find("markers: a")));
  EXPECT_EQ(folder.calibration.gravity, Eigen::Vector3d(0, -9.81, 0));
  EXPECT_NEAR(folder.trials[0].clock.lag_s, 1000.0, 2e-3);
  project_.measurement.expected_lag_s = 50.0;
  EXPECT_THROW(Read(), InputError);
}

TEST_F(RecordingFolderTest, NeedsEveryJointThatMovesAMarker) {
  ScriptedTrial played = Write("a", {.postures = 4});
  Write("b", {.postures = 4});
  played.log.names.pop_back();
  const std::string missing = MakeMarkedRobot(project_).tree.joints.back().name;
  played.log.positions = played.log.positions.leftCols(played.log.positions.cols() - 1).eval();
  played.log.torques = played.log.torques.leftCols(played.log.torques.cols() - 1).eval();
  WriteJointLog(folder_.path() / "a.csv", played.log);
  ExpectInputError([&] { Read(); }, {"a.csv", missing, "swing", "not_recorded_deg"});
  // The project says that the joint stood still, but the other log shows that it moved.
  project_.recording.not_recorded[missing] = 0.1;
  const RecordingFolder folder = Read();
  EXPECT_TRUE(folder.calibration.joints_not_recorded.empty());
  const std::string expected = missing + ": only some logs have its positions; in those of swing ";
  EXPECT_TRUE(std::ranges::any_of(folder.findings, [&](const std::string& finding) {
    return finding.starts_with(expected) && finding.find("at 5.72958 deg") != std::string::npos;
  }));
}

TEST_F(RecordingFolderTest, TellsRecordingFoldersFromOthers) {
  EXPECT_FALSE(IsRecordingFolder(folder_.path()));
  const std::string file = folder_.Write("experiment.yaml", "");
  EXPECT_TRUE(IsRecordingFolder(folder_.path()));
  EXPECT_FALSE(IsRecordingFolder(file));
  ExpectInputError([&] { ReadRecordingFolders({}, project_); }, {"no recording folder"});
}

}  // namespace
}  // namespace elastocal
