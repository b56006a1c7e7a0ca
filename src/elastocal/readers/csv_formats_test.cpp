// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/readers/recording_file.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/recording_writers.hpp"

namespace elastocal {
namespace {

RecordingFile ReadCsv(const std::string& text, const ReaderOptions& options = {}) {
  return ReadRecordingFile(ByteSource::OfMemory(text, "file"), options);
}

MarkerTrajectories ThreeMarkers() {
  MarkerTrajectories made{"made", {"A", "B", "C"}, 120.0, Eigen::MatrixXd(50, 9)};
  for (Eigen::Index i = 0; i < 50; ++i) {
    for (Eigen::Index k = 0; k < 9; ++k) {
      made.positions(i, k) = 1e-3 * static_cast<double>(100 * k - i);
    }
  }
  made.positions.row(0).tail<3>().setConstant(kNaN);
  made.positions.block(20, 3, 9, 3).setConstant(kNaN);
  return made;
}

void ExpectMade(const RecordingFile& file, const std::string& prefix = "") {
  const MarkerTrajectories made = ThreeMarkers();
  ASSERT_TRUE(file.markers.has_value()) << file.why_no_markers;
  for (std::size_t m = 0; m < 3; ++m) EXPECT_EQ(file.markers->names[m], prefix + made.names[m]);
  EXPECT_EQ(file.markers->rate_hz, made.rate_hz);
  ASSERT_EQ(file.markers->frame_count(), made.frame_count());
  for (Eigen::Index i = 0; i < made.positions.size(); ++i) {
    const double a = file.markers->positions(i), b = made.positions(i);
    ASSERT_TRUE((std::isnan(a) && std::isnan(b)) || std::abs(a - b) < 1e-15) << i;
  }
  EXPECT_EQ(file.up, "");  // no such file states it
}

/// The text as a spreadsheet saves it in a country with decimal commas, which also changes its
/// numbers.
std::string Resaved(std::string text, char separator) {
  std::ranges::replace(text, ',', separator);
  for (std::size_t i = 1; i + 1 < text.size(); ++i) {
    const auto digit = [&](std::size_t k) { return text[k] >= '0' && text[k] <= '9'; };
    if (text[i] == '.' && digit(i - 1) && digit(i + 1)) text[i] = ',';
  }
  return text;
}

std::string Replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

TEST(RecordingFileTest, WhatIsSomethingElseIsNamed) {
  const auto expect = [](const std::string& bytes, const std::string& words) {
    ExpectInputError([&] { RecogniseRecording(ByteSource::OfMemory(bytes, "file")); },
                     {"file: it is " + words});
  };
  expect("\x1F\x8B\x08", "compressed by gzip");
  expect("\x28\xB5\x2F\xFD....", "compressed by zstd");
  expect("\x93NUMPY\x01", "a single array");
  expect("\x89HDF\r\n\x1A\n", "an HDF5 or MATLAB file");
  expect(
      "\xFF\xFE"
      "t",
      "text in UTF-16");
  expect("version https://git-lfs.github.com/spec/v1\noid", "a pointer of Git LFS");
  expect("<!DOCTYPE html><html>", "a web page");
}

TEST(ViconTest, TrajectoriesBesideOtherSections) {
  const std::string text = ViconText(ThreeMarkers());
  const RecordingFile file = ReadCsv(text);
  EXPECT_EQ(file.format, "Vicon Nexus CSV");
  ExpectMade(file, "talos:");
  EXPECT_EQ(file.notes, (std::vector<std::string>{"the section Devices is passed over"}));
  // Nexus 2.16 writes this: two empty lines, then only this section. Lines end with CR LF.
  std::string alone = "\n\n" + text.substr(text.find("Trajectories"));
  for (std::size_t at = 0; (at = alone.find('\n', at)) != std::string::npos; at += 2) {
    alone.insert(at, "\r");
  }
  ExpectMade(ReadCsv(alone), "talos:");
  for (const char separator : {';', '\t'}) ExpectMade(ReadCsv(Resaved(text, separator)), "talos:");
  // Either all numbers of a file have a decimal comma, or none.
  std::string mixed = Resaved(text, ';');
  mixed.replace(mixed.rfind(','), 1, ".");
  ExpectInputError([&] { ReadCsv(mixed); }, {"a number with a decimal comma, as others above"});
}

TEST(ViconTest, MistakesAreNamed) {
  const std::string text = ViconText(ThreeMarkers());
  ExpectInputError([&] { ReadCsv(Replaced(text, "\n120\n", "\nx\n")); }, {"file:9", "'x'"});
  ExpectInputError([&] { ReadCsv(Replaced(text, "mm,mm,mm", "mm,m,mm")); }, {"file:12", "'m'"});
  ExpectInputError([&] { ReadCsv(Replaced(text, "mm,mm,mm,mm,mm,mm,mm,mm,mm", ",,,,,,,,")); },
                   {"unit of length", "markers_unit"});
  ExpectInputError([&] { ReadCsv(Replaced(text, "\n103,", "\n104,")); }, {"file:15", "102", "104"});
  ExpectInputError([&] { ReadCsv(Replaced(text, "-1.000,99.000", "-1.000,")); },
                   {"file:14", "X, Y and Z"});
  ExpectInputError([&] { ReadCsv(Replaced(text, "X,Y,Z,X", "X,Z,Y,X")); }, {"file:11", "'Y'"});
  ExpectInputError([&] { ReadCsv(text.substr(0, text.find("\n101"))); }, {"file:12", "no frame"});
  EXPECT_FALSE(ReadCsv(text.substr(0, text.find("Traj"))).markers.has_value());
}

// A file that was cut off may end within a number, which is another number then.
TEST(RecordingFileTest, ALastRowWithoutALineEndIsPassedOver) {
  const MarkerTrajectories made = ThreeMarkers();
  for (std::string text : {ViconText(made), TrcText(made), MotiveText(made)}) {
    while (text.back() == '\n') text.pop_back();
    for (const int cut : {0, 2}) {
      const RecordingFile file =
          ReadCsv(text.substr(0, text.size() - static_cast<std::size_t>(cut)));
      ASSERT_TRUE(file.markers.has_value());
      EXPECT_EQ(file.markers->frame_count(), made.frame_count() - 1) << file.format;
      EXPECT_TRUE(file.markers->positions.row(48).isApprox(made.positions.row(48), 1e-12));
      EXPECT_NE(file.notes.back().find("no line end"), std::string::npos) << file.format;
    }
  }
}

TEST(TrcTest, FieldByField) {
  const RecordingFile file = ReadCsv(TrcText(ThreeMarkers()));
  EXPECT_EQ(file.format, "TRC");
  ExpectMade(file);
  ExpectMade(ReadCsv(Resaved(TrcText(ThreeMarkers()), '\t')));
}

TEST(TrcTest, MistakesAreNamed) {
  const std::string text = TrcText(ThreeMarkers());
  ExpectInputError([&] { ReadCsv(Replaced(text, "\tmm\n", "\tfurlong\n")); },
                   {"'furlong'", "markers_unit"});
  ExpectInputError([&] { ReadCsv(Replaced(text, "\t50\t3\t", "\t51\t3\t")); }, {"51"});
  ExpectInputError([&] { ReadCsv(Replaced(text, "\t50\t3\t", "\t50\t4\t")); },
                   {"file:4", "NumMarkers"});
  ExpectInputError([&] { ReadCsv(Replaced(text, "\n3\t0.01667", "\n3\t0.02667")); },
                   {"file:9", "Time"});
  ExpectInputError([&] { ReadCsv(Replaced(text, "DataRate\t", "Rate\t")); }, {"DataRate"});
  ExpectInputError([&] { ReadCsv(text.substr(0, 60)); }, {"file"});
}

TEST(MotiveTest, MarkersWithColumnsOfQuality) {
  const RecordingFile file = ReadCsv(MotiveText(ThreeMarkers()));
  EXPECT_EQ(file.format, "OptiTrack Motive CSV");
  ExpectMade(file);
  ExpectMade(ReadCsv(Resaved(MotiveText(ThreeMarkers()), ';')));
}

/// Motive 2 exports a body like this: one measured marker, and the position that the body's model
/// has for it.
const char* const kBodyTake =
    "Format Version,1.23,Take Name,\"a, b\",Export Frame Rate,100.000000,Rotation Type,Quaternion,"
    "Length Units,Meters,Coordinate Space,Global\n"
    "\n"
    ",Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid "
    "Body,Rigid Body Marker,Rigid Body Marker,Rigid Body Marker,Rigid Body "
    "Marker,Marker,Marker,Marker\n"
    ",Name,hand,hand,hand,hand,hand,hand,hand,hand,hand:Marker1,hand:Marker1,hand:Marker1,"
    "hand:Marker1,Unlabeled 7,Unlabeled 7,Unlabeled 7\n"
    ",ID,1,1,1,1,1,1,1,1,2,2,2,2,3,3,3\n"
    ",,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Mean Marker "
    "Error,Position,Position,Position,Marker Quality,Position,Position,Position\n"
    "Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,,X,Y,Z,,X,Y,Z\n"
    "4,0.040000,0,0,0.70710678,0.70710678,1,2,3,0.0001,9,9,9,1,0.5,0.6,0.7\n"
    "5,0.050000,,,,,,,,,9,9,9,1,,,\n";

TEST(MotiveTest, RigidBodiesAreFourMarkers) {
  const RecordingFile file = ReadCsv(kBodyTake);
  const MarkerTrajectories& markers = *file.markers;
  EXPECT_EQ(markers.names,
            (std::vector<std::string>{"Unlabeled 7", "hand_1", "hand_2", "hand_3", "hand_4"}));
  EXPECT_EQ(markers.rate_hz, 100.0);
  ASSERT_EQ(markers.frame_count(), 2);
  Eigen::RowVectorXd expected(15);  // turned about z by 90 degrees
  expected << 0.5, 0.6, 0.7, 1, 2, 3, 1, 2.1, 3, 0.9, 2, 3, 1, 2, 3.1;
  EXPECT_LT((markers.positions.row(0) - expected).norm(), 1e-9);
  EXPECT_TRUE(markers.positions.row(1).array().isNaN().all());
  EXPECT_EQ(file.notes.size(), 1u);  // about the positions of the model
}

// Motive exported such files in 2016 (format 1.21).
TEST(MotiveTest, RowsOfTheHeaderWithoutNames) {
  std::string text = kBodyTake;
  for (const char* name : {"Type", "Name", "ID"}) {
    text = Replaced(text, std::string("\n,") + name + ",", "\n,,");
  }
  text = Replaced(text, "Time (Seconds)", "Time");
  const RecordingFile unnamed = ReadCsv(text), named = ReadCsv(kBodyTake);
  ASSERT_TRUE(unnamed.markers.has_value());
  EXPECT_EQ(unnamed.markers->names, named.markers->names);
  EXPECT_EQ(unnamed.markers->positions.row(0), named.markers->positions.row(0));
}

TEST(MotiveTest, MistakesAreNamed) {
  const std::string text = kBodyTake;
  ExpectInputError([&] { ReadCsv(Replaced(text, "Length Units,Meters,", "")); },
                   {"unit of length", "--unit"});
  ExpectInputError([&] { ReadCsv(Replaced(text, "100.000000", "")); }, {"file:1", "Frame Rate"});
  ExpectInputError([&] { ReadCsv(Replaced(text, "100.000000", "40")); }, {"file:9", "Time"});
  ExpectInputError([&] { ReadCsv(Replaced(text, "Global", "Local")); }, {"file:1", "Local"});
  ExpectInputError([&] { ReadCsv(Replaced(text, "0.6,0.7", "0.6,x")); }, {"file:8", "'x'"});
  ExpectInputError([&] { ReadCsv(text.substr(0, text.find("\n4,"))); }, {"no frame"});
  ExpectInputError([&] { ReadCsv(Replaced(text, "Quaternion", "XYX")); },
                   {"file:1", "Rotation Type: found 'XYX'", "Quaternion, XYZ, XZY, YXZ, YZX, ZXY"});
  ExpectInputError([&] { ReadCsv(Replaced(text, "Rotation Type,Quaternion,", "")); },
                   {"file:1", "Rotation Type: found ''"});
  ExpectInputError([&] { ReadCsv(Replaced(text, "Quaternion", "XYZ")); },
                   {"file:7", "column 3", "'hand'", "X, Y, Z of Rotation Type XYZ"});
}

/// The body of kBodyTake with Euler angles about X, Y and Z in degrees.
std::string EulerTake(const std::string& order, const std::string& angles) {
  std::string text = Replaced(kBodyTake, "Quaternion", order);
  text = Replaced(text, ",Type,Rigid Body,", ",Type,");
  text = Replaced(text, ",Name,hand,", ",Name,");
  text = Replaced(text, ",ID,1,", ",ID,");
  text = Replaced(text, ",,Rotation,", ",,");
  text = Replaced(text, "X,Y,Z,W,", "X,Y,Z,");
  text = Replaced(text, "0,0,0.70710678,0.70710678", angles);
  return Replaced(text, "5,0.050000,,", "5,0.050000,");
}

TEST(MotiveTest, EulerAnglesTurnAboutAxesThatTurned) {
  // The body turns about X and then about its Z, which X has turned to -Y. So its x axis comes to
  // lie along z. With fixed axes it would lie along y.
  Eigen::RowVectorXd expected(15);
  expected << 0.5, 0.6, 0.7, 1, 2, 3, 1, 2, 3.1, 0.9, 2, 3, 1, 1.9, 3;
  const RecordingFile file = ReadCsv(EulerTake("XYZ", "90,0,90"));
  EXPECT_LT((file.markers->positions.row(0) - expected).norm(), 1e-9);
  EXPECT_TRUE(file.markers->positions.row(1).array().isNaN().all());
  expected << 0.5, 0.6, 0.7, 1, 2, 3, 1, 2.1, 3, 1, 2, 3.1, 1.1, 2, 3;
  EXPECT_LT((ReadCsv(EulerTake("ZYX", "90,0,90")).markers->positions.row(0) - expected).norm(),
            1e-9);
  ExpectInputError([&] { ReadCsv(EulerTake("XYZ", "90,,90")); }, {"file:8", "X, Y and Z"});
  ExpectInputError([&] { ReadCsv(EulerTake("Quaternion", "90,0,90")); },
                   {"file:7", "X, Y, Z, W of Rotation Type Quaternion"});
}

TEST(MotiveTest, EveryOrderOfEulerAngles) {
  const Eigen::Vector3d angles(0.4, -1.1, 2.3);
  const Eigen::Vector3d degrees = angles * 180.0 / M_PI;
  const std::string cells =
      FormatNumber(degrees.x()) + "," + FormatNumber(degrees.y()) + "," + FormatNumber(degrees.z());
  for (const std::string order : {"XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"}) {
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    for (const char axis : order) {
      const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis - 'X');
      R *= Eigen::AngleAxisd(angles[axis - 'X'], unit).toRotationMatrix();
    }
    const auto row = ReadCsv(EulerTake(order, cells)).markers->positions.row(0).eval();
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d axis = (row.segment<3>(6 + 3 * k) - row.segment<3>(3)).transpose();
      EXPECT_LT((axis - 0.1 * R.col(k)).norm(), 1e-9) << order << k;
    }
  }
}

TEST(MotiveTest, MarkersAloneNeedNoRotationType) {
  const std::string text = MotiveText(ThreeMarkers());
  const std::size_t at = text.find("Rotation Type,");
  ASSERT_NE(at, std::string::npos);
  std::string other = text;
  other.replace(at, text.find(',', at + 14) - at, "Rotation Type,Odd");
  ExpectMade(ReadCsv(other));
}

/// Two lines of a recording by QTM itself (shiplab/dt_cv, M510A-IRR-EKFPID-020019_6D.tsv), and a
/// line in which the body is missing.
const char* const kQtmBodies =
    "NO_OF_FRAMES\t3\nNO_OF_CAMERAS\t4\nNO_OF_BODIES\t1\nFREQUENCY\t100\nNO_OF_ANALOG\t0\n"
    "DATA_INCLUDED\t6D\nBODY_NAMES\tPSVH\n"
    "Frame\tTime\tPSVH X\tY\tZ\tRoll\tPitch\tYaw\tResidual\tRot[0]\tRot[1]\tRot[2]\tRot[3]\tRot[4]"
    "\tRot[5]\tRot[6]\tRot[7]\tRot[8]\t\n"
    "1\t0.00000\t-194.91974\t2.24150\t0.99661\t-0.65630\t0.09391\t0.05772\t4.98536\t1.00000\t"
    "0.00099\t-0.00165\t-0.00101\t0.99993\t-0.01145\t0.00164\t0.01145\t0.99993\t\n"
    "2\t0.01000\t-195.64748\t1.62077\t0.72224\t-0.78772\t0.05832\t0.12055\t4.77517\t1.00000\t"
    "0.00209\t-0.00105\t-0.00210\t0.99990\t-0.01375\t0.00102\t0.01375\t0.99990\t\n"
    "3\t0.02000\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t\n";

TEST(QtmOtherTest, BodiesOfTheirOwnExport) {
  const RecordingFile file = ReadCsv(kQtmBodies);
  const MarkerTrajectories& markers = *file.markers;
  EXPECT_EQ(markers.names.front(), "PSVH_1");
  EXPECT_EQ(markers.rate_hz, 100.0);
  ASSERT_EQ(markers.frame_count(), 3);
  EXPECT_NEAR(markers.positions(1, 0), -0.19564748, 1e-12);
  const RecordingFile resaved = ReadCsv(Resaved(kQtmBodies, '\t'));
  EXPECT_EQ(resaved.markers->positions.topRows(2), markers.positions.topRows(2));
  // QTM states these angles (its matrix has five decimals). The body's y axis, 100 mm long, rises
  // by sin(roll), and its x axis turns by yaw.
  const double roll = -0.78772 * kRadiansPerDegree, yaw = 0.12055 * kRadiansPerDegree;
  EXPECT_NEAR(markers.positions(1, 8) - markers.positions(1, 2), 0.1 * std::sin(roll), 2e-6);
  EXPECT_NEAR(markers.positions(1, 4) - markers.positions(1, 1), 0.1 * std::sin(yaw), 2e-6);
  EXPECT_TRUE(markers.positions.row(2).array().isNaN().all());
}

TEST(QtmOtherTest, OtherKindsAndMistakes) {
  const std::string text = kQtmBodies;
  const RecordingFile analog = ReadCsv("TOT_NO_OF_CHAN\t1\nDATA_INCLUDED\tANALOG\n1.5\n");
  EXPECT_FALSE(analog.markers.has_value());
  EXPECT_NE(analog.why_no_markers.find("'ANALOG'"), std::string::npos);
  ExpectInputError([&] { ReadCsv(Replaced(text, "Rot[3]", "Rot[9]")); }, {"file:8", "'Rot[3]'"});
  ExpectInputError([&] { ReadCsv(Replaced(text, "\t0.99993\t", "\t0.5\t")); },
                   {"file:9", "rotation"});
  ExpectInputError([&] { ReadCsv(Replaced(text, "FRAMES\t3", "FRAMES\t4")); }, {"NO_OF_FRAMES"});
  ExpectInputError([&] { ReadCsv(Replaced(text, "PSVH X", "X")); }, {"file:"});
}

}  // namespace
}  // namespace elastocal
