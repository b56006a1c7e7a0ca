// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/readers/recording_file.hpp"
#include "elastocal/tables/read_file.hpp"
#include "tests/bag_writers.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

RecordingFile ReadArchive(const std::string& bytes, const ReaderOptions& options = {}) {
  return ReadRecordingFile(ByteSource::OfMemory(bytes, "log"), options);
}

std::string Numpy(const std::string& name) { return SourceFile("tests/recordings/" + name); }

// NumPy itself wrote this file (tests/recordings/make_npz.py): compressed, with several types and
// orders.
TEST(NpzTest, ColumnsOfNumpy) {
  const RecordingFile file = ReadRecordingFile(Numpy("joints_columns.npz"), {});
  EXPECT_EQ(file.format, "NumPy .npz");
  const JointLog& log = file.joints.value();
  EXPECT_EQ(log.names, (std::vector<std::string>{"elbow", "shoulder"}));
  ASSERT_EQ(log.sample_count(), 6);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(log.time_s[i], 100.0 + 0.125 * i);
    EXPECT_EQ(log.positions(i, 0), 0.25 * i - 0.5);
    EXPECT_EQ(log.positions(i, 1), i - 3);
    EXPECT_TRUE(i == 2 ? std::isnan(log.torques(i, 0)) : log.torques(i, 0) == 0.5 * i - 1.0);
    EXPECT_TRUE(std::isnan(log.torques(i, 1)));
  }
  EXPECT_EQ(file.notes, (std::vector<std::string>{"the array image is passed over"}));
}

TEST(NpzTest, MatricesOfNumpy) {
  const JointLog log = ReadRecordingFile(Numpy("joints_matrix.npz"), {}).joints.value();
  EXPECT_EQ(log.names, (std::vector<std::string>{"elbow", "sch\xC3\xB6ne_schulter"}));
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(log.positions(i, 0), 0.25 * i - 0.5);
    EXPECT_EQ(log.positions(i, 1), i - 3);
    EXPECT_EQ(log.torques(i, 1), 2 * (i - 3));
  }
}

// Arrays of records, with padding between their fields or with matrices as fields.
TEST(NpzTest, RecordsOfNumpy) {
  for (const bool matrix : {false, true}) {
    const RecordingFile file =
        ReadRecordingFile(Numpy(matrix ? "joints_records_matrix.npz" : "joints_records.npz"), {});
    const JointLog& log = file.joints.value();
    EXPECT_EQ(log.names[0], "elbow");
    EXPECT_EQ(log.names.back(), "shoulder");
    ASSERT_EQ(log.sample_count(), 6);
    const Eigen::Index shoulder = log.positions.cols() - 1;
    for (int i = 0; i < 6; ++i) {
      EXPECT_EQ(log.time_s[i], 100.0 + 0.125 * i);
      EXPECT_EQ(log.positions(i, 0), 0.25 * i - 0.5);
      EXPECT_EQ(log.positions(i, shoulder), i - 3);
      EXPECT_EQ(log.torques(i, 0), 0.5 * i - 1.0);
    }
  }
  const auto notes = [](const char* name) { return ReadRecordingFile(Numpy(name), {}).notes; };
  EXPECT_EQ(notes("joints_records.npz"),
            (std::vector<std::string>{"the field force is passed over",
                                      "the field label is passed over"}));
  EXPECT_EQ(notes("joints_records_matrix.npz"),  // an array of objects, which is not needed
            (std::vector<std::string>{"the array about is passed over"}));
}

TEST(NpzTest, HandMadeArchive) {
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(4, 0.0, 0.3), q = Eigen::VectorXd::Random(4);
  const JointLog log = ReadArchive(NpzBytes({{"t", t}, {"elbow", q}})).joints.value();
  EXPECT_EQ(log.time_s, t);
  EXPECT_EQ(log.positions.col(0), q);
}

// The name of the array states the unit of the time. Otherwise the message asks for it.
TEST(NpzTest, TimeIsInTheUnitThatIsStated) {
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(21, 5.0, 7.0),
                        q = Eigen::VectorXd::Random(21);
  const auto read = [&](const std::string& name, double unit, const std::string& given = "") {
    const auto bytes = NpzBytes({{name, t / unit}, {"elbow", q}});
    return ReadArchive(bytes, {.time_unit = given}).joints.value().time_s;
  };
  EXPECT_LT((read("time_ns", 1e-9) - t).norm(), 1e-12);
  EXPECT_LT((read("t_ms", 1e-3) - t).norm(), 1e-12);
  EXPECT_LT((read("t", 1e-6, "us") - t).norm(), 1e-12);
  for (const double unit : {1e-9, 1e-6, 1e-3}) {
    ExpectInputError(
        [&] { read("t", unit); },
        {"log: most samples would be",
         "joints_time_unit of the trial in experiment.yaml, with 'info'", "--time-unit"});
  }
  ExpectInputError([&] { read("t_ms", 1e-3, "us"); }, {"log: states", "'ms', not 'us'"});
  ExpectInputError([&] { read("t", 1.0, "min"); }, {"'min'", "s, ms, us or ns"});
}

// numpy.datetime64, which pandas uses for times, and numpy.timedelta64 have their own units.
TEST(NpzTest, TimesOfNumpy) {
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(4, 0.0, 0.3);
  for (const char* name : {"joints_datetime.npz", "joints_timedelta.npz"}) {
    const JointLog log = ReadRecordingFile(Numpy(name), {}).joints.value();
    EXPECT_LT(((log.time_s.array() - log.time_s[0]).matrix() - t).norm(), 1e-6) << name;
  }
  EXPECT_NEAR(ReadRecordingFile(Numpy("joints_datetime.npz"), {}).joints->time_s[0], 1.7e9, 1e-6);
}

// What a list of names says, are the names of the joints.
TEST(NpzTest, NamesOfAListKeepTheirEndings) {
  const JointLog log = ReadRecordingFile(Numpy("joints_endings.npz"), {}).joints.value();
  EXPECT_EQ(log.names, (std::vector<std::string>{"a", "lift_position", "wheel_velocity"}));
  EXPECT_EQ(log.positions.row(1), Eigen::RowVector3d(0.6, 0.4, 0.5));
  EXPECT_EQ(log.torques.row(1), Eigen::RowVector3d(6.0, 4.0, 5.0));
}

TEST(NpzTest, MistakesAreNamed) {
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(4, 0.0, 0.3), q = Eigen::VectorXd::Random(4);
  const std::string good = NpzBytes({{"t", t}, {"elbow", q}});
  std::string bad = good;
  bad[bad.find("elbow.npy") + 9 + 128 + 8] ^= 1;  // changes an element, which the checksum tells
  ExpectInputError([&] { ReadArchive(bad); }, {"log: array 'elbow.npy': byte", "CRC"});
  ExpectInputError([&] { ReadArchive(good.substr(0, good.size() - 30)); },
                   {"log: byte", "archive"});
  ExpectInputError(
      [&] {
        ReadArchive(NpzBytes({{"t", q}, {"elbow", t}}));
      },
      {"log: sample", "time"});
  ExpectInputError(
      [&] {
        ReadArchive(NpzBytes({{"t", t}, {"elbow_torque", q}}));
      },
      {"'elbow'", "positions are missing"});
  ExpectInputError(
      [&] {
        ReadArchive(NpzBytes({{"t", t}, {"a", q}, {"a_position", q}}));
      },
      {"'a'", "two columns"});
  ExpectInputError([&] { ReadArchive(NpzBytes({{"t", t}})); }, {"no array of any joint"});
  EXPECT_FALSE(ReadArchive(NpzBytes({{"q", t}})).joints.has_value());
  ExpectInputError([&] { ReadRecordingFile(Numpy("joints_pickled.npz"), {}); },
                   {"'t.npy'", "'|O'", "floats"});
}

}  // namespace
}  // namespace elastocal
