// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include <gtest/gtest.h>

#include "elastocal/io/joint_log.hpp"
#include "elastocal/io/recording_folder.hpp"
#include "elastocal/readers/qtm_tsv.hpp"
#include "elastocal/recorded/measurements.hpp"
#include "elastocal/tables/read_file.hpp"
#include "tests/bag_writers.hpp"
#include "tests/c3d_writer.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/recording_writers.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"
#include "tests/trial_player.hpp"

namespace elastocal {
namespace {

/// A trial of a virtual robot with gaps, which is written in every format.
class ForeignRecordingsTest : public testing::Test {
 protected:
  void SetUp() override {
    played_ = Play(MakeMarkedRobot(project_),
                   {.postures = 8, .standing = FindLink(project_.tree, "right_sole")});
    played_.markers.positions.block(100, 0, 40, 3).setConstant(std::nan(""));
    WriteQtmTsv(folder_.path() / "a.tsv", played_.markers);
    WriteJointLog(folder_.path() / "a.csv", played_.log);
    // Rounded to micrometres, the positions are the same in every format.
    played_.markers = ReadQtmTsv(folder_.path() / "a.tsv");
  }

  Measurements Read(const std::string& markers, const std::string& joints,
                    const std::string& first = "up: z\n", const std::string& more = "") {
    folder_.Write("experiment.yaml",
                  first +
                      "trials: [{name: check, chain: left_leg, support: [right_sole], markers: " +
                      markers + ", joints: " + joints + more + "}]");
    return ReadMeasurements(project_, {folder_.path()});
  }

  void ExpectSame(const Measurements& read, double tolerance = 0.0) {
    const Measurements tsv = Read("a.tsv", "a.csv");
    const Recording &a = read.calibration, &b = tsv.calibration;
    EXPECT_EQ(a.marker_names, b.marker_names);
    EXPECT_EQ(a.gravity, b.gravity);
    ASSERT_EQ(a.posture_count(), 8);
    ASSERT_EQ(b.posture_count(), 8);
    // Markers that differ by nanometres change the lag by microseconds.
    EXPECT_LE((a.q - b.q).cwiseAbs().maxCoeff(), 10.0 * tolerance);
    ASSERT_EQ(a.markers.size(), b.markers.size());
    for (Eigen::Index i = 0; i < a.markers.size(); ++i) {
      const bool gap = std::isnan(b.markers(i));
      ASSERT_EQ(std::isnan(a.markers(i)), gap);
      ASSERT_TRUE(gap || std::abs(a.markers(i) - b.markers(i)) <= tolerance) << i;
    }
  }

  Project project_ = ReadProject(SourceFile("tests/robots/mini_humanoid_project.yaml"));
  ScratchFolder folder_;
  ScriptedTrial played_;
};

// The samples have the same bits, so that all that is computed from them is the same as well.
TEST_F(ForeignRecordingsTest, TextFormatsGiveTheSameSamples) {
  folder_.Write("a.vicon", ViconText(played_.markers));
  folder_.Write("a.trc", TrcText(played_.markers));
  folder_.Write("a.motive", MotiveText(played_.markers));
  for (const char* file : {"a.vicon", "a.trc", "a.motive"}) {
    SCOPED_TRACE(file);
    ExpectSame(Read(file, "a.csv"));
  }
}

// Floats of 32 bits round to 60 nm at a metre.
TEST_F(ForeignRecordingsTest, C3dGivesTheSameSamples) {
  folder_.Write("a.c3d", C3dWriter(played_.markers, {.processor = 85, .analog = 6}).Write());
  ExpectSame(Read("a.c3d", "a.csv", ""), 2e-7);
}

TEST_F(ForeignRecordingsTest, LogsOfRosAndNumpyGiveTheSameSamples) {
  folder_.Write("a.mcap", McapBytes(played_.log));
  std::vector<std::pair<std::string, Eigen::VectorXd>> columns = {{"t", played_.log.time_s}};
  for (std::size_t k = 0; k < played_.log.names.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    columns.emplace_back(played_.log.names[k], played_.log.positions.col(column));
    if (played_.log.torques.col(column).array().isNaN().all()) continue;
    columns.emplace_back(played_.log.names[k] + "_torque", played_.log.torques.col(column));
  }
  for (std::size_t i = 0; i < played_.log.wrench_sensors.size(); ++i) {
    const std::string& name = played_.log.wrench_sensors[i].name;
    Eigen::Index column = 6 * static_cast<Eigen::Index>(i);
    for (const char* ending : {"_fx", "_fy", "_fz", "_tx", "_ty", "_tz"}) {
      columns.emplace_back(name + ending, played_.log.wrenches.col(column++));
    }
  }
  folder_.Write("a.npz", NpzBytes(columns));
  ExpectSame(Read("a.tsv", "a.npz"));
  ExpectSame(Read("a.tsv", "a.mcap"));
}

TEST_F(ForeignRecordingsTest, WhatTheFileDoesNotSayIsAskedFor) {
  folder_.Write("a.trc", TrcText(played_.markers));
  ExpectInputError([&] { Read("a.trc", "a.csv", ""); }, {"a.trc", "points up", "'up: z'"});
  folder_.Write("a.c3d", C3dWriter(played_.markers, {.units = ""}).Write());
  ExpectInputError([&] { Read("a.c3d", "a.csv", "up: y\n", ", markers_unit: mm"); },
                   {"a.c3d", "axis z", "experiment.yaml"});
  ExpectInputError([&] { Read("a.c3d", "a.csv"); }, {"a.c3d", "markers_unit"});
  ExpectSame(Read("a.c3d", "a.csv", "", ", markers_unit: mm"), 2e-7);
  ExpectInputError([&] { Read("a.c3d", "a.csv", "", ", markers_unit: furlong"); },
                   {"experiment.yaml", "furlong", "mm, cm"});
  // Positions in a Qualisys TSV are always in mm.
  ExpectInputError([&] { Read("a.tsv", "a.csv", "", ", markers_unit: m"); },
                   {"a.tsv", "states the unit 'mm', not 'm'"});
  ExpectInputError([&] { Read("a.csv.npz", "a.csv"); }, {"a.csv.npz"});
  JointLog in_ms = played_.log;
  in_ms.time_s *= 1e3;
  WriteJointLog(folder_.path() / "ms.csv", in_ms);
  ExpectInputError([&] { Read("a.tsv", "ms.csv"); }, {"ms.csv: most samples", "joints_time_unit"});
  ExpectSame(Read("a.tsv", "ms.csv", "", ", joints_time_unit: ms"), 2e-7);
  ExpectInputError([&] { Read("a.tsv", "ms.csv", "", ", joints_time_unit: min"); },
                   {"experiment.yaml", "min", "s, ms, us or ns"});
  folder_.Write("b.npz", NpzBytes({{"t", played_.log.time_s}, {"nose", played_.log.time_s}}));
  ExpectInputError([&] { Read("a.tsv", "b.npz"); }, {"b.npz", "'nose'", "recording.ignore"});
  ExpectInputError([&] { Read("b.npz", "a.csv"); }, {"b.npz", "no markers"});
}

// One bag holds poses of rigid bodies and joint states, with times that count from 1970.
TEST_F(ForeignRecordingsTest, OneBagHoldsBoth) {
  std::string text = ReadFile(SourceFile("tests/robots/mini_humanoid_project.yaml"));
  const std::string points = "positions_mm: [[0, 0, 0], [100, 0, 0], [0, 100, 0], [0, 0, 100]]}";
  for (std::size_t at = 0; (at = text.find("positions_mm", at)) != std::string::npos; ++at) {
    text.replace(at, text.find('}', at) + 1 - at, points);
  }
  project_ = ParseProject(text, project_.file);
  constexpr double kStart = 1.7e9;
  ScriptedTrial played =
      Play(MakeMarkedRobot(project_), {.postures = 8,
                                       .lag_s = 0.75,
                                       .marker_sd = 0.0,
                                       .standing = FindLink(project_.tree, "right_sole")});
  played.markers.positions.block(700, 0, 30, 12).setConstant(std::nan(""));
  WriteQtmTsv(folder_.path() / "a.tsv", played.markers, 9);
  WriteJointLog(folder_.path() / "a.csv", played.log);
  JointLog stamped = played.log;
  stamped.time_s.array() += kStart;
  // The first frame is at -0.75 s of the log's clock.
  folder_.Write("a.mcap", McapBytes(stamped, &played.markers, kStart - 0.75));
  ExpectSame(Read("a.mcap", "a.mcap"), 1e-6);
  ExpectInputError([&] { Read("a.mcap", "a.mcap", ""); }, {"a.mcap", "points up"});
  folder_.Write("b.mcap", McapBytes(stamped, &played.markers, kStart - 0.75, true));
  const Measurements poses = Read("a.mcap", "a.mcap");
  const Measurements transforms = Read("b.mcap", "b.mcap", "up: z\n", ", tf_frame: world");
  EXPECT_EQ(transforms.calibration.q, poses.calibration.q);  // the same bits
  ExpectInputError([&] { Read("b.mcap", "b.mcap", "up: z\n", ", tf_frame: word"); },
                   {"b.mcap", "no frame 'word'", "did you mean 'world'"});
}

TEST_F(ForeignRecordingsTest, LabelsOfOthersAreNamedInTheProject) {
  MarkerTrajectories others = played_.markers;
  std::string labels = "recording: {labels: {";
  for (std::size_t m = 0; m < others.names.size(); ++m) {
    labels += (m > 0 ? ", " : "") + others.names[m] + ": hand " + std::to_string(m);
    others.names[m] = "hand " + std::to_string(m);
  }
  folder_.Write("a.trc", TrcText(others));
  const std::string text = ReadFile(SourceFile("tests/robots/mini_humanoid_project.yaml"));
  const Project plain = project_;
  project_ = ParseProject(text + labels + "}}\n", plain.file);
  const Measurements read = Read("a.trc", "a.csv");
  project_ = plain;
  ExpectSame(read);
}

}  // namespace
}  // namespace elastocal
