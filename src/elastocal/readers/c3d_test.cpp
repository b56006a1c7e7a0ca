// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/readers/c3d_parameters.hpp"
#include "elastocal/readers/recording_file.hpp"
#include "tests/c3d_writer.hpp"
#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

/// Positions that floats of 32 bits and tenths of a millimetre can hold exactly.
MarkerTrajectories SomeMarkers(int frames, int markers) {
  MarkerTrajectories made{"made", {}, 250.0, {}};
  for (int m = 0; m < markers; ++m) made.names.push_back("M" + std::to_string(m));
  made.positions.resize(frames, 3 * markers);
  for (int i = 0; i < frames; ++i) {
    for (int k = 0; k < 3 * markers; ++k)
      made.positions(i, k) = 1e-3 * ((i % 100) + 0.5 * k - 20.0);
  }
  if (frames > 2) made.positions.row(2).segment<3>(0).setConstant(kNaN);
  return made;
}

RecordingFile ReadBytes(const std::string& bytes, const ReaderOptions& options = {}) {
  return ReadRecordingFile(ByteSource::OfMemory(bytes, "a.bin"), options);
}

void ExpectSame(const MarkerTrajectories& read, const MarkerTrajectories& made) {
  ASSERT_EQ(read.names, made.names);
  ASSERT_EQ(read.frame_count(), made.frame_count());
  EXPECT_EQ(read.rate_hz, made.rate_hz);
  for (Eigen::Index i = 0; i < made.positions.size(); ++i) {
    const double a = read.positions(i), b = made.positions(i);
    // Converting mm to metres costs the rounding of one product.
    ASSERT_TRUE((std::isnan(a) && std::isnan(b)) || std::abs(a - b) < 1e-15) << i;
  }
}

// The hand values are for the three types of processors.
TEST(C3dTest, NumbersOfEachProcessor) {
  EXPECT_EQ(C3dReal("\x00\x00\x80\x3F", C3dProcessor::kIntel), 1.0f);
  EXPECT_EQ(C3dReal("\x3F\x80\x00\x00", C3dProcessor::kMips), 1.0f);
  EXPECT_EQ(C3dReal("\x80\x40\x00\x00", C3dProcessor::kDec), 1.0f);  // VAX F: 0.5 * 2^(129 - 128)
  EXPECT_EQ(C3dReal("\x20\xC1\x00\x00", C3dProcessor::kDec), -2.5f);
  EXPECT_EQ(C3dReal("\x00\x00\x00\x00", C3dProcessor::kDec), 0.0f);
  EXPECT_EQ(C3dInteger("\xFE\xFF", C3dProcessor::kDec), -2);
  EXPECT_EQ(C3dInteger("\xFF\xFE", C3dProcessor::kMips), -2);
}

TEST(C3dTest, EveryProcessorAndNumberFormat) {
  const MarkerTrajectories made = SomeMarkers(7, 3);
  for (const int processor : {84, 85, 86}) {
    for (const bool real : {true, false}) {
      for (const int analog : {0, 24}) {
        SCOPED_TRACE(testing::Message() << processor << real << analog);
        const C3dStyle style{
            .processor = processor, .real = real, .integer_scale = 0.5, .analog = analog};
        const RecordingFile file = ReadBytes(C3dWriter(made, style).Write());
        EXPECT_EQ(file.format, "C3D");
        EXPECT_EQ(file.up, "z");
        ASSERT_TRUE(file.markers.has_value());
        ExpectSame(*file.markers, made);
        EXPECT_EQ(file.notes.size(), analog > 0 ? 1u : 0u);
      }
    }
  }
}

TEST(C3dTest, LongListsOfLabelsAndResultsOfModels) {
  MarkerTrajectories made = SomeMarkers(3, 300);
  RecordingFile file = ReadBytes(C3dWriter(made, {.labels_a_list = 120}).Write());
  ExpectSame(*file.markers, made);
  // Vicon writes angles among the points. An unlabelled point has no name.
  made.names[1] = "LKneeAngles";
  made.names[2] = "";
  file = ReadBytes(C3dWriter(made, {.labels_a_list = 120, .angles = {"LKneeAngles"}}).Write());
  EXPECT_EQ(file.markers->names.size(), 298u);
  EXPECT_EQ(file.markers->names[1], "M3");
  EXPECT_EQ(file.markers->positions(0, 3), made.positions(0, 9));
  EXPECT_EQ(file.notes.size(), 2u);
}

TEST(C3dTest, MoreFramesThanSixteenBits) {
  const MarkerTrajectories made = SomeMarkers(70000, 1);
  for (const char* counted : {"FRAMES", "TRIAL", "LONG_FRAMES", "wrapped"}) {
    SCOPED_TRACE(counted);
    const RecordingFile file =
        ReadBytes(C3dWriter(made, {.analog = 128, .counted_by = counted}).Write());
    ExpectSame(*file.markers, made);
  }
}

TEST(C3dTest, UnitAndAxisAreStatedOrAskedFor) {
  const MarkerTrajectories made = SomeMarkers(4, 2);
  const std::string metres =
      C3dWriter(made, {.units = "m", .y_screen = "+Y", .metres = 1.0}).Write();
  EXPECT_EQ(ReadBytes(metres).up, "y");
  // A float of 32 bits cannot hold decimals exactly.
  EXPECT_NEAR(ReadBytes(metres).markers->positions(3, 1), made.positions(3, 1), 1e-8);
  ExpectInputError([&] { ReadBytes(metres, {.unit = "mm"}); }, {"a.bin", "'m'", "'mm'"});
  const std::string silent = C3dWriter(made, {.units = "", .y_screen = ""}).Write();
  EXPECT_EQ(ReadBytes(silent, {.unit = "mm"}).up, "");
  ExpectSame(*ReadBytes(silent, {.unit = "mm"}).markers, made);
  ExpectInputError([&] { ReadBytes(silent); }, {"a.bin", "unit", "markers_unit"});
  ExpectInputError([&] { ReadBytes(silent, {.unit = "feet of Ada"}); }, {"feet of Ada"});
}

TEST(C3dTest, DamageIsNamedWithItsPlace) {
  const std::string good = C3dWriter(SomeMarkers(40, 3), {}).Write();
  ExpectInputError([&] { ReadBytes(good.substr(0, good.size() - 600)); },
                   {"a.bin: byte " + std::to_string(good.size() - 600), "of 40 frames"});
  ExpectInputError([&] { ReadBytes(good.substr(0, 700)); }, {"a.bin: byte 700", "ends"});
  std::string bad = good;
  bad[515] = 83;
  ExpectInputError([&] { ReadBytes(bad); }, {"byte 515", "processor type 83"});
  bad = good;
  bad[good.find("USED") + 6] = 9;  // its type
  ExpectInputError([&] { ReadBytes(bad); }, {"parameter USED", "type 9"});
  ExpectInputError([&] { ReadBytes("LP_joint,RP_joint\n1,2\n"); }, {"no known format", "C3D"});
}

// The file's name does not reveal the format. Only the parts that are kept use memory.
TEST(C3dTest, FilesAreReadPieceByPiece) {
  MarkerTrajectories made = SomeMarkers(3000, 2);
  const std::string bytes = C3dWriter(made, {.processor = 86, .analog = 60}).Write();
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "c3d_test.tsv";
  std::ofstream(file, std::ios::binary) << bytes;
  made.source = file.string();
  const RecordingFile read = ReadRecordingFile(file, {});
  ExpectSame(*read.markers, made);
  EXPECT_EQ(read.markers->source, file.string());
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace elastocal
