// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/recording_info.hpp"

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "elastocal/readers/qtm_tsv.hpp"
#include "elastocal/tables/read_file.hpp"
#include "tests/bag_writers.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/recording_writers.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

MarkerTrajectories TwoMarkers() {
  MarkerTrajectories markers{"made", {"A", "B"}, 10.0, Eigen::MatrixXd(40, 6)};
  for (Eigen::Index i = 0; i < 40; ++i)
    markers.positions.row(i) << 0.1, 0.2, 0.3, 1, 2, 0.01 * (i + 1.);
  markers.positions.block(10, 0, 15, 3).setConstant(std::nan(""));
  return markers;
}

TEST(RecordingInfoTest, SaysWhenWhichMarkerWasSeen) {
  const ScratchFolder folder;
  const std::string file = folder.Write("x", TrcText(TwoMarkers()));
  const RecordingInfo info = DescribeRecording(file, {}, 8);
  ASSERT_EQ(info.sights.size(), 2u);
  EXPECT_EQ(info.sights[0].seen_share, 25.0 / 40.0);
  EXPECT_EQ(info.sights[0].gaps, 1);
  EXPECT_NEAR(info.sights[0].longest_gap_s, 1.5, 1e-12);
  EXPECT_EQ(info.sights[0].share_by_part, (std::vector<double>{1, 1, 0, 0, 0, 1, 1, 1}));
  EXPECT_EQ(info.sights[1].gaps, 0);
  const auto json = nlohmann::json::parse(MakeInfoJson(info));
  EXPECT_EQ(json["format"], "TRC");
  EXPECT_TRUE(json["markers"]["up"].is_null());
  EXPECT_EQ(json["markers"]["list"][0]["share_by_part"][2], 0.0);
  EXPECT_TRUE(json["joints"].is_null());
}

TEST(RecordingInfoTest, ShowsTheColumnsOfOtherTables) {
  const ScratchFolder folder;
  const std::string file =
      folder.Write("touches.csv", "contact,hip,x1\nc_21,0.5,\nc_24,-0.25,3e-1\n");
  const RecordingInfo info = DescribeRecording(file, {}, 8);
  const auto json = nlohmann::json::parse(MakeInfoJson(info));
  EXPECT_EQ(json["format"], "table (CSV)");
  EXPECT_EQ(json["postures"]["count"], 2);
  EXPECT_EQ(json["postures"]["columns"].dump(),
            R"([{"filled":2,"largest":null,"least":null,"name":"contact"},)"
            R"({"filled":2,"largest":0.5,"least":-0.25,"name":"hip"},)"
            R"({"filled":1,"largest":0.3,"least":0.3,"name":"x1"}])");
  ExpectInputError([&] { ConvertRecording(file, {}, RecordingPart::kOnlyOne, ""); },
                   {"no column 't' or 'time'", "calibrate"});
  const std::string log = folder.Write("log.csv", "time,hip,knee\n0,,\n\n");
  ExpectInputError([&] { DescribeRecording(log, {}, 8); }, {"no row below the header"});
}

// Twenty touches with times are no log. A log in ms is accepted if the user states the unit.
TEST(RecordingInfoTest, RowsThatAreSecondsApartAreNoLogUnlessAUnitIsGiven) {
  const ScratchFolder folder;
  std::string text = "t,hip\n";
  for (int i = 0; i < 20; ++i) text += std::to_string(10 * i) + ",0.5\n";
  const std::string file = folder.Write("table.csv", text);
  const RecordingInfo info = DescribeRecording(file, {}, 8);
  ASSERT_EQ(info.file.format, "table (CSV)");
  EXPECT_NE(info.file.notes.front().find("most rows are 10 apart by the column 't'"),
            std::string::npos);
  ExpectInputError([&] { ConvertRecording(file, {}, RecordingPart::kOnlyOne, ""); },
                   {"nor a joint log", "--time-unit"});
  const RecordingInfo log = DescribeRecording(file, {.time_unit = "ms"}, 8);
  EXPECT_EQ(log.file.format, "joint log (CSV)");
  EXPECT_NEAR(log.log_rate_hz, 100.0, 1e-9);
}

TEST(RecordingInfoTest, OfARecordingFolderAFileIsAskedFor) {
  const ScratchFolder folder;
  folder.Write("experiment.yaml", "trials: []\n");
  const std::filesystem::path inside = std::filesystem::path(folder.Write("a", "")).parent_path();
  ExpectInputError([&] { DescribeRecording(inside, {}, 8); },
                   {"is a folder", "one of those that its experiment.yaml names"});
}

TEST(RecordingInfoTest, KnowsAPostureTableByItsColumns) {
  const ScratchFolder folder;
  const std::string header = "t,A_x,A_y,A_z,hip,knee,B_x,B_y,B_z,C_x\n";
  const std::string file = folder.Write("x", header +
                                                 "0,1,2,3,0.1,0.2,,,,0\n"
                                                 "5,1,2,3,0.2,0.2,1,2,3,0\n"
                                                 "9,nan,NaN,nan,0.2,0.2,1,2,3,0\n");
  const auto json = nlohmann::json::parse(MakeInfoJson(DescribeRecording(file, {}, 8)));
  EXPECT_EQ(json["format"], "posture table (CSV)");
  EXPECT_TRUE(json["markers"].is_null());
  EXPECT_TRUE(json["joints"].is_null());
  EXPECT_EQ(json["postures"]["count"], 3);
  EXPECT_EQ(json["postures"]["markers"].dump(), R"([{"name":"A","seen":2},{"name":"B","seen":2}])");
  EXPECT_EQ(json["postures"]["joints"].dump(), R"(["hip","knee","C_x"])");
  ExpectInputError([&] { ConvertRecording(file, {}, RecordingPart::kOnlyOne, ""); },
                   {"posture table", "calibrate"});
  // A log may have joints with such names. Its rows follow each other quickly.
  const std::string log =
      folder.Write("log", "t,hip_x,hip_y,hip_z\n0,0,0,0\n0.01,0,0,0\n0.02,0,0,0\n");
  EXPECT_EQ(DescribeRecording(log, {}, 8).file.joints->names.size(), 3u);
}

// The converted file has z up, whatever pointed up before. It is turned and not mirrored.
TEST(RecordingInfoTest, ConvertsWithZUp) {
  const ScratchFolder folder;
  MarkerTrajectories axes{"made", {"X", "Y", "Z"}, 10.0, Eigen::MatrixXd(1, 9)};
  axes.positions << 1, 0, 0, 0, 1, 0, 0, 0, 1;
  const std::string file = folder.Write("x", TrcText(axes));
  ExpectInputError([&] { ConvertRecording(file, {}, RecordingPart::kOnlyOne, ""); }, {"--up"});
  for (const std::string up : {"x", "y", "z", "-x", "-y", "-z"}) {
    SCOPED_TRACE(up);
    const MarkerTrajectories turned =
        ParseQtmTsv(ConvertRecording(file, {}, RecordingPart::kOnlyOne, up).text, "converted");
    const Eigen::Map<const Eigen::Matrix3d> rotation(turned.positions.data());
    EXPECT_TRUE((rotation.transpose() * rotation).isIdentity(1e-12));
    EXPECT_NEAR(rotation.determinant(), 1.0, 1e-12);
    Eigen::Vector3d axis = Eigen::Vector3d::Zero();
    axis[up.back() - 'x'] = up[0] == '-' ? -1.0 : 1.0;
    EXPECT_LT((rotation * axis - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  }
  ExpectInputError([&] { ConvertRecording(file, {}, RecordingPart::kJoints, "z"); },
                   {"no joint positions"});
}

TEST(RecordingInfoTest, ConvertsOnePartOfABag) {
  const std::string bag = SourceFile("tests/recordings/bag_zstd.mcap");
  ExpectInputError([&] { ConvertRecording(bag, {}, RecordingPart::kOnlyOne, "z"); }, {"--part"});
  const ConvertedRecording joints = ConvertRecording(bag, {}, RecordingPart::kJoints, "");
  EXPECT_EQ(joints.text.substr(0, joints.text.find('\n')), "t,elbow,wrist");
  EXPECT_EQ(joints.warnings.size(), 1u);  // one message lacks efforts
  const ConvertedRecording markers = ConvertRecording(bag, {}, RecordingPart::kMarkers, "z");
  ASSERT_EQ(markers.warnings.size(), 1u);  // the clock is no longer common to both
  EXPECT_NE(markers.warnings[0].find("expected_lag_s: -1.7e+09"), std::string::npos)
      << markers.warnings[0];
  const MarkerTrajectories body = ParseQtmTsv(markers.text, "converted");
  EXPECT_EQ(body.frame_count(), 20);
  EXPECT_TRUE(std::isnan(body.positions(7, 0)));
  EXPECT_NEAR(body.positions(3, 0), 1.03, 1e-9);
  // If a file has neither part, the message says so of both.
  const ScratchFolder folder;
  JointLog log;
  log.names = {"elbow"};
  log.time_s = log.positions = log.torques = Eigen::MatrixXd::Zero(1, 1);
  const std::string other = folder.Write("other", McapBytes(log));
  ExpectInputError(
      [&] { ConvertRecording(other, {.joints_topic = "/no"}, RecordingPart::kOnlyOne, "z"); },
      {"no poses", "no joint states in the topic '/no'"});
}

// PlotJuggler exports two topics like this if both have states of the same joint.
TEST(RecordingInfoTest, NamesTheColumnsOfTwoTopicsWithOneJoint) {
  const ScratchFolder folder;
  const std::string log = folder.Write(
      "log.csv", "__time,/arm/hip/position,/body/hip/position\n0,0,0\n0.01,0,0\n0.02,0,0\n");
  ExpectInputError([&] { DescribeRecording(log, {}, 8); },
                   {"log.csv", "'/arm/hip/position' and '/body/hip/position'", "leave one"});
}

TEST(RecordingInfoTest, OptionsThatWouldDoNothingAreRefused) {
  const ScratchFolder folder;
  const std::string log = folder.Write("log.csv", "t,hip\n0,0\n0.01,0\n0.02,0\n");
  const std::string bag = SourceFile("tests/recordings/bag_zstd.mcap");
  const auto refused = [](const std::string& file, const ReaderOptions& options,
                          const std::string& name) {
    ExpectInputError([&] { DescribeRecording(file, options, 8); }, {name, "do nothing"});
    ExpectInputError([&] { ConvertRecording(file, options, RecordingPart::kJoints, ""); },
                     {name, "do nothing"});
  };
  refused(log, {.joints_topic = "/joint_states"}, "--topic");
  refused(log, {.tf_frame = "room"}, "--tf-frame");
  refused(log, {.tf_bodies = {"hand"}}, "--tf-bodies");
  refused(log, {.salvage = true}, "--salvage");
  refused(log, {.unit = "mm"}, "--unit");
  refused(bag, {.time_unit = "ms"}, "--time-unit");
  ExpectInputError([&] { ConvertRecording(log, {}, RecordingPart::kJoints, "z"); }, {"--up"});
  EXPECT_NO_THROW(DescribeRecording(log, {.time_unit = "s"}, 8));
  EXPECT_NO_THROW(DescribeRecording(bag, {.salvage = true}, 8));
}

}  // namespace
}  // namespace elastocal
