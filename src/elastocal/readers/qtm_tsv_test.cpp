// SPDX-License-Identifier: Apache-2.0
#include "elastocal/readers/qtm_tsv.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/files/output_files.hpp"
#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

/// A header as QTM writes it, with the markers A and "B 2".
const std::string kTsvHeader =
    "NO_OF_FRAMES\t3\r\nNO_OF_CAMERAS\t20\r\nNO_OF_MARKERS\t2\r\nFREQUENCY\t100\r\n"
    "NO_OF_ANALOG\t0\r\nANALOG_FREQUENCY\t0\r\nDESCRIPTION\t--\r\n"
    "TIME_STAMP\t2021-03-04, 10:38:02.123\t30235.1\r\nDATA_INCLUDED\t3D\r\n"
    "EVENT\tstart\t1\t0.00000\r\nEVENT\tend\t3\t0.02000\r\nMARKER_NAMES\tA\tB 2\r\n"
    "TRAJECTORY_TYPES\tMeasured\tMixed\r\n";
const std::string kTsvColumns = "Frame\tTime\tA X\tA Y\tA Z\tB 2 X\tB 2 Y\tB 2 Z\r\n";
/// The shortest sufficient header.
const std::string kShortTsv = "FREQUENCY\t100\nMARKER_NAMES\tA\tB\n";

MarkerTrajectories ParseTsv(const std::string& text) { return ParseQtmTsv(text, "t.tsv"); }

void ExpectTsvError(const std::string& text, std::initializer_list<std::string> parts) {
  ExpectInputError([&] { ParseTsv(text); }, parts);
}

/// Rounding of products with 1e-3.
constexpr double kTsvRounding = 1e-15;

TEST(QtmTsv, ReadsWhatQtmWrites) {
  const MarkerTrajectories t =
      ParseTsv(kTsvHeader + kTsvColumns +
               "1\t0.00000\t100.5\t-20\t1e3\t4\t5\t6\r\n2\t0.01000\t101\t-21\t1001\t\t\t\r\n"
               "3\t0.02000\t0.000\t0.000\t0.000\t0.000\t0.000\t6.5\r\n");
  EXPECT_EQ(t.source, "t.tsv");
  EXPECT_EQ(t.names, (std::vector<std::string>{"A", "B 2"}));
  EXPECT_EQ(t.rate_hz, 100.0);
  ASSERT_EQ(t.frame_count(), 3);
  Eigen::RowVectorXd first(6);
  first << 0.1005, -0.02, 1.0, 0.004, 0.005, 0.006;
  EXPECT_TRUE(t.positions.row(0).isApprox(first, kTsvRounding));
  EXPECT_NEAR(t.positions(1, 2), 1.001, kTsvRounding);
  EXPECT_TRUE(t.positions.block(1, 3, 1, 3).array().isNaN().all());
  EXPECT_TRUE(t.positions.block(2, 0, 1, 3).array().isNaN().all());
  // This is no gap, because one coordinate is not zero.
  EXPECT_EQ(t.positions(2, 3), 0.0);
  EXPECT_NEAR(t.positions(2, 5), 0.0065, kTsvRounding);
}

TEST(QtmTsv, RefusesNamesThatAreNotUtf8) {
  ExpectTsvError("FREQUENCY\t100\nMARKER_NAMES\tcaf\xe9\n", {"t.tsv:2: ", "UTF-8"});
  ExpectTsvError("FREQUENCY\t100\nFrame\tTime\tcaf\xe9 X\tcaf\xe9 Y\tcaf\xe9 Z\n",
                 {"t.tsv:2: ", "UTF-8"});
}

TEST(QtmTsv, InfersTheColumnsFromTheirNumber) {
  for (const char* end : {"", "\t"}) {
    for (const char* leading : {"", "7\t", "7\t0.5\t"}) {
      const std::string row = std::string(leading) + "\t\t\t4\t5\t6" + end + "\n";
      const MarkerTrajectories t = ParseTsv(kShortTsv + row);
      ASSERT_EQ(t.frame_count(), 1) << row;
      EXPECT_TRUE(std::isnan(t.positions(0, 0))) << row;
      EXPECT_NEAR(t.positions(0, 5), 0.006, kTsvRounding) << row;
    }
  }
  // With one cell more than six, either a frame number comes first and the last marker has a gap,
  // or the line ends with a tab.
  EXPECT_NEAR(ParseTsv(kShortTsv + "7\t1\t2\t3\t\t\t\n").positions(0, 0), 0.001, kTsvRounding);
  EXPECT_NEAR(ParseTsv(kShortTsv + "1\t2\t3\t\t\t\t\n").positions(0, 0), 0.001, kTsvRounding);
}

TEST(QtmTsv, NeedsNoHeader) {
  const MarkerTrajectories t = ParseTsv(
      "\xEF\xBB\xBF"
      "Time\tA X\tA Y\tA Z\n0.5\t1\t2\t3\n0.525\t1\t2\t3\n0.55\t1\t2\t3");
  EXPECT_EQ(t.names, std::vector<std::string>{"A"});
  EXPECT_NEAR(t.rate_hz, 40.0, 1e-12);  // from rounded times
  EXPECT_EQ(t.frame_count(), 3);
}

TEST(QtmTsv, FindsTheRate) {
  const std::string names = "MARKER_NAMES\tA\n";
  EXPECT_NEAR(ParseTsv(names + "0.00\t1\t2\t3\n0.01\t1\t2\t3\n0.02\t1\t2\t3\n").rate_hz, 100.0,
              1e-9);
  EXPECT_EQ(ParseTsv("FREQUENCY\t300\n" + names + "4\t1\t2\t3\n5\t1\t2\t3\n").rate_hz, 300.0);
  const std::string advice = "FREQUENCY<tab>100";
  ExpectTsvError(names + "1\t2\t3\n1\t2\t3\n", {"t.tsv", "rate is not known", advice});
  ExpectTsvError(names + "4\t1\t2\t3\n5\t1\t2\t3\n", {"rate is not known", advice});
  ExpectTsvError(names + "4\t0.1\t1\t2\t3\n", {"rate is not known", advice});
  ExpectTsvError("FREQUENCY\t0\n" + names + "1\t2\t3\n", {"t.tsv:1: FREQUENCY", "'0'"});
  ExpectTsvError("FREQUENCY\t100;5\n" + names + "1\t2\t3\n", {"t.tsv:1: FREQUENCY", "'100;5'"});
}

// The clock of another device drives the cameras, and a time code stands beside the time.
TEST(QtmTsv, AnExternalTimebaseAndATimeCode) {
  const std::string head = "FREQUENCY\tEXT\nMARKER_NAMES\tA\n";
  const MarkerTrajectories t =
      ParseTsv(head +
               "Frame\tTime\tSMPTE\tA X\tA Y\tA Z\n1\t0.00\t10:38:02:12\t1\t2\t3\n"
               "2\t0.01\t10:38:02:13\t4\t5\t6\n");
  EXPECT_NEAR(t.rate_hz, 100.0, 1e-9);
  EXPECT_NEAR(t.positions(1, 2), 0.006, kTsvRounding);
  ExpectTsvError(head + "Frame\tA X\tA Y\tA Z\n1\t1\t2\t3\n", {"rate is not known"});
  ExpectTsvError(head + "Frame\tSMPTE\tSMPTE\tA X\n", {"t.tsv:3: column 3", "second column"});
}

TEST(QtmTsv, TrajectoriesWithoutANameArePassedOver) {
  const std::string names = "FREQUENCY\t100\nNO_OF_MARKERS\t4\nMARKER_NAMES\tA\t\tB\t\n";
  const std::string row = "1\t2\t3\t4\t5\t6\t7\t8\t9\t10\t11\t12\n";
  const auto expect = [&](const MarkerTrajectories& t) {
    EXPECT_EQ(t.names, (std::vector<std::string>{"A", "B"}));
    ASSERT_EQ(t.positions.cols(), 6);
    EXPECT_NEAR(t.positions(0, 0), 0.001, kTsvRounding);
    EXPECT_NEAR(t.positions(0, 3), 0.007, kTsvRounding);
  };
  expect(ParseTsv(names + row));
  const std::string columns = "A X\tA Y\tA Z\t X\t Y\t Z\tB X\tB Y\tB Z\t X\t Y\t Z\n";
  expect(ParseTsv(names + columns + row));
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "unnamed.tsv";
  WriteFile(file, names + row + row.substr(0, row.size() - 2));
  std::vector<std::string> notes;
  const MarkerTrajectories t = ReadQtmTsv(file, &notes);
  std::filesystem::remove(file);
  expect(t);
  EXPECT_EQ(t.frame_count(), 1);  // no line end follows the last row
  ASSERT_EQ(notes.size(), 2u);
  EXPECT_EQ(notes[0], "2 trajectories without a name are passed over");
}

TEST(QtmTsv, FramesFollowEachOther) {
  const std::string head = "FREQUENCY\t100\nMARKER_NAMES\tA\nFrame\tTime\tA X\tA Y\tA Z\n";
  const std::string cells = "\t1\t2\t3\n";
  ExpectTsvError(head + "7\t0.00" + cells + "8\t0.01" + cells + "10\t0.03" + cells,
                 {"t.tsv:6: ", "Frame", "10 after 8"});
  ExpectTsvError(head + "7\t0.00" + cells + "8\t0.02" + cells,
                 {"t.tsv:5: ", "Time", "0.02 after 0"});
  ExpectTsvError(head + "7\t0.00" + cells + "8\t0.00" + cells, {"t.tsv:5: ", "Time", "not later"});
  // Each step of 0.012 s differs from 0.01 s by less than half a frame, but their sum does not.
  ExpectTsvError(head + "7\t0" + cells + "8\t.012" + cells + "9\t.024" + cells + "10\t.036" + cells,
                 {"t.tsv:7: ", "Time", "0.036 s", "FREQUENCY, 100", "0.03 s"});
  EXPECT_EQ(ParseTsv(head + "7\t5.00" + cells + "8\t5.01" + cells).rate_hz, 100.0);
}

// QTM writes numbers in the format that Windows uses in the user's country.
TEST(QtmTsv, DecimalCommasAreThoseOfAllNumbers) {
  const std::string points =
      "FREQUENCY\t99.5\nMARKER_NAMES\tA\tB\nFrame\tTime\tA X\tA Y\tA Z\tB X\tB Y\tB Z\n"
      "1\t0.00000\t1.250\t-2.500\t3\t\t\t\n2\t0.01005\t1.5\t2.5\t3.5\t4\t5\t6.25\n";
  std::string commas = points;
  std::replace(commas.begin(), commas.end(), '.', ',');
  const MarkerTrajectories expected = ParseTsv(points), found = ParseTsv(commas);
  EXPECT_EQ(found.rate_hz, expected.rate_hz);
  const Eigen::MatrixXd seen = expected.positions.array().isNaN().select(-1.0, expected.positions);
  EXPECT_EQ(found.positions.array().isNaN().select(-1.0, found.positions).matrix(), seen);
  EXPECT_NEAR(found.positions(0, 1), -2.5e-3, 1e-12);
  std::string mixed = commas;
  mixed.replace(mixed.rfind("6,25"), 4, "6.25");
  ExpectTsvError(mixed, {"t.tsv:5: column 8 (B Z)", "'6.25'", "decimal comma, as others above"});
  mixed = points;
  mixed.replace(mixed.rfind("6.25"), 4, "6,25");
  ExpectTsvError(mixed, {"t.tsv:5: column 8 (B Z)", "'6,25'", "decimal point"});
}

TEST(QtmTsv, GapsHaveManyShapes) {
  for (const char* gap : {"\t\t", "0\t0\t0", "0.000\t-0.000\t0", "NaN\tNaN\tnan",
                          "NULL\tNULL\tnull", " \tNaN\tNULL"}) {
    const MarkerTrajectories t = ParseTsv(kShortTsv + gap + "\t4\t5\t6\n1\t2\t3\t" + gap);
    ASSERT_EQ(t.frame_count(), 2) << gap;
    EXPECT_TRUE(t.positions.block(0, 0, 1, 3).array().isNaN().all()) << gap;
    EXPECT_TRUE(t.positions.block(1, 3, 1, 3).array().isNaN().all()) << gap;
    EXPECT_NEAR(t.positions(0, 5), 0.006, kTsvRounding) << gap;
  }
  ExpectTsvError(kShortTsv + "1\t2\t3\t4\t5\t6\n1\t2\t3\t4\t\t6\n",
                 {"t.tsv:4: column 4 (B X)", "X, Y and Z, or none"});
}

TEST(QtmTsv, NamesWrongCells) {
  const std::string good = "1\t2\t3\t4\t5\t6\n";
  for (const char* wrong :
       {"1,234,5", "1.234,5", "abc", "inf", "-inf", "1e999", "2 3", "0x10", "--1"}) {
    ExpectTsvError(kShortTsv + good + "1\t2\t3\t4\t" + wrong + "\t6\n",
                   {"t.tsv:4: column 5 (B Y)", "'" + std::string(wrong) + "'", "decimal point"});
  }
  EXPECT_NEAR(ParseTsv(kShortTsv + "1\t2\t3\t4\t5\t +6 \n").positions(0, 5), 0.006, kTsvRounding);
  ExpectTsvError(kShortTsv + good + "1\t2\t3\t4\t5\n", {"t.tsv:4: ", "5 cells", "6"});
  ExpectTsvError(kShortTsv + good + good.substr(0, 11) + "\t7\n", {"t.tsv:4: ", "7 cells"});
  ExpectTsvError(kShortTsv + "1\t2\t3\n", {"t.tsv:3: ", "3 cells", "6"});
  ExpectTsvError(kShortTsv + "1\t2\t3\t4\t5\t6\t\t\t\t\n", {"t.tsv:3: ", "10 cells", "8"});
  ExpectTsvError(kShortTsv + "1\t2\t3\t4\t5\t6\t\n1\t2\t3\t4\t5\t6\t7\n", {"t.tsv:4: column 7"});
  ExpectTsvError(kShortTsv + good + "\n" + good, {"t.tsv:5: ", "below an empty line"});
  ExpectTsvError(kTsvHeader + kTsvColumns + "1\tNULL\t1\t2\t3\t4\t5\t6\n",
                 {":15: column 2 (Time)", "'NULL'"});
  ExpectTsvError(kShortTsv + std::string("1\t2\t3\t4\t5\t6\0", 12), {"t.tsv:3: ", "NUL"});
}

TEST(QtmTsv, NamesWrongHeaders) {
  ExpectTsvError("", {"t.tsv:1: ", "MARKER_NAMES"});
  ExpectTsvError("1\t2\t3\n", {"t.tsv:1: ", "MARKER_NAMES"});
  ExpectTsvError(kShortTsv, {"t.tsv", "no frame"});
  ExpectTsvError(kShortTsv + "\r\n\r\n", {"t.tsv", "no frame"});
  ExpectTsvError("MARKER_NAMES\tA\tA\n", {"t.tsv:1: ", "two markers", "'A'"});
  ExpectTsvError("MARKER_NAMES\t\t\n1\t2\t3\n", {"t.tsv:2: ", "nothing above names"});
  ExpectTsvError("MARKER_NAMES\tA\nMARKER_NAMES\tA\n", {"t.tsv:2: ", "second line MARKER_NAMES"});
  ExpectTsvError("NO_OF_MARKERS\t3\n" + kShortTsv + "1\n", {"t.tsv:4: ", "2 markers", "is 3"});
  ExpectTsvError("NO_OF_MARKERS\tmany\n", {"t.tsv:1: NO_OF_MARKERS", "'many'", "whole number"});
  ExpectTsvError("NO_OF_FRAMES\t2\n" + kShortTsv + "1\t2\t3\t4\t5\t6\n",
                 {"t.tsv", "1 frames", "is 2"});
  ExpectTsvError("DATA_INCLUDED\t6D\n", {"t.tsv:1: ", "'6D'", "3D"});
  ExpectTsvError("marker,x,y\n", {"t.tsv:1: column 1", "'marker,x,y'", "header line"});
  ExpectTsvError("Frame\tFrame\tA X\tA Y\tA Z\n", {"t.tsv:1: column 2", "second column Frame"});
  ExpectTsvError("Frame\tA X\tA Y\tB Z\n", {"t.tsv:1: column 4", "'B Z'", "'A Z'"});
  ExpectTsvError("Frame\tA X\tA Y\n", {"t.tsv:1: ", "'A'", "not complete"});
  ExpectTsvError(kShortTsv + "B X\tB Y\tB Z\tA X\tA Y\tA Z\n", {"t.tsv:3: ", "other markers"});
  ExpectTsvError("DESCRIPTION\t" + std::string(1 << 20, 'x') + "\n", {"t.tsv:1: ", "1 MiB"});
  std::string endless;
  for (int i = 0; i < 10001; ++i) endless += "A\n";
  ExpectTsvError(endless, {"t.tsv:10001: ", "more than 10000 lines"});
}

TEST(QtmTsv, WritesWhatItReads) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "written.tsv";
  MarkerTrajectories written = ParseTsv(
      "FREQUENCY\t120.5\nMARKER_NAMES\tA\tB "
      "2\n1.0004\t-2.5\t1234.567\t4\t5\t6\n\t\t\t0\t0\t0.001\n");
  WriteQtmTsv(file, written);
  const std::string text = ReadFile(file);
  EXPECT_NE(text.find("\r\nFREQUENCY\t120.5\r\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\r\n1\t0.00000\t1.000\t-2.500\t1234.567\t4.000\t5.000\t6.000\r\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("\r\n2\t0.00830\t\t\t\t0.000\t0.000\t0.001\r\n"), std::string::npos) << text;
  MarkerTrajectories read = ReadQtmTsv(file);
  EXPECT_EQ(read.source, file.string());
  EXPECT_EQ(read.names, written.names);
  EXPECT_EQ(read.rate_hz, written.rate_hz);
  EXPECT_TRUE(std::isnan(read.positions(1, 0)));
  // Three decimals of a millimetre round by at most half a micrometre.
  EXPECT_LT((read.positions.row(0) - written.positions.row(0)).cwiseAbs().maxCoeff(), 0.5e-6);
  WriteQtmTsv(file, written, 12);
  read = ReadQtmTsv(file);
  EXPECT_TRUE(read.positions.row(0).isApprox(written.positions.row(0), kTsvRounding));
  written.names = {"A, \"left\"", "\"B\""};
  WriteQtmTsv(file, written);
  EXPECT_EQ(ReadQtmTsv(file).names, written.names);
  std::filesystem::remove(file);
  written.names[1] = "B\t2";
  ExpectInputError([&] { WriteQtmTsv(file, written); }, {"cannot hold", "'B?2'"});
}

TEST(QtmTsv, NamesAFileThatCannotBeRead) {
  ExpectInputError([] { ReadQtmTsv("nowhere/t.tsv"); }, {"nowhere/t.tsv", "no such file"});
}

}  // namespace
}  // namespace elastocal
