// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/readers/recording_file.hpp"
#include "elastocal/readers/ros_messages.hpp"
#include "elastocal/tables/read_file.hpp"
#include "tests/bag_writers.hpp"
#include "tests/count_in.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

RecordingFile ReadBag(const std::string& bytes, const ReaderOptions& options = {}) {
  return ReadRecordingFile(ByteSource::OfMemory(bytes, "bag"), options);
}

/// Checks a bag that tests/recordings/make_bags.mjs wrote with other libraries.
void ExpectMadeBag(const RecordingFile& file) {
  ASSERT_TRUE(file.joints.has_value()) << file.why_no_joints;
  const JointLog& log = *file.joints;
  EXPECT_EQ(log.names, (std::vector<std::string>{"elbow", "wrist"}));
  ASSERT_EQ(log.sample_count(), 10);
  for (int i = 0; i < 10; ++i) {
    EXPECT_NEAR(log.time_s[i], 1.7e9 + 0.02 * i, 3e-7);  // precision of such times as double
    EXPECT_EQ(log.positions(i, 0), 0.25 * i);
    EXPECT_EQ(log.positions(i, 1), -1.0 * i);
    EXPECT_TRUE(std::isnan(log.torques(i, 1)));
    EXPECT_TRUE(i == 2 ? std::isnan(log.torques(i, 0)) : log.torques(i, 0) == 2.0 * i);
  }
  ASSERT_TRUE(file.markers.has_value()) << file.why_no_markers;
  const MarkerTrajectories& body = *file.markers;
  EXPECT_EQ(body.names, (std::vector<std::string>{"LHAND_1", "LHAND_2", "LHAND_3", "LHAND_4"}));
  EXPECT_NEAR(body.rate_hz, 100.0, 1e-9);
  EXPECT_NEAR(file.markers_start_s.value(), 1.7e9, 1e-6);
  ASSERT_EQ(body.frame_count(), 20);
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(body.positions.row(i).array().isNaN().any(), i == 7);
    if (i == 7) continue;
    const double x = 1.0 + 0.01 * i;
    Eigen::RowVectorXd expected(12);  // turned about z by 90 degrees
    expected << x, -2, 0.5, x, -1.9, 0.5, x - 0.1, -2, 0.5, x, -2, 0.6;
    EXPECT_LT((body.positions.row(i) - expected).norm(), 1e-12) << i;
  }
  EXPECT_EQ(file.notes.size(), 3u);  // one per topic
}

TEST(BagsTest, McapOfItsOwnLibrary) {
  for (const char* name : {"bag_none.mcap", "bag_lz4.mcap", "bag_zstd.mcap"}) {
    SCOPED_TRACE(name);
    const RecordingFile file =
        ReadRecordingFile(SourceFile(std::string("tests/recordings/") + name), {});
    EXPECT_EQ(file.format, "MCAP");
    ExpectMadeBag(file);
  }
}

TEST(BagsTest, BagsOfRos1) {
  for (const char* name : {"bag1_none.bag", "bag1_lz4.bag", "bag1_bz2.bag"}) {
    SCOPED_TRACE(name);
    const RecordingFile file =
        ReadRecordingFile(SourceFile(std::string("tests/recordings/") + name), {});
    EXPECT_EQ(file.format, "ROS 1 bag");
    ExpectMadeBag(file);
  }
}

TEST(BagsTest, DatabaseOfSqlite) {
  const std::filesystem::path file = SourceFile("tests/recordings/bag.db3");
  ExpectMadeBag(ReadRecordingFile(file, {}));
  ExpectMadeBag(ReadBag(ReadFile(file)));
}

/// The same libraries wrote the same poses as transforms, among the transforms of a robot.
TEST(BagsTest, TransformsAreThePosesOfBodies) {
  const RecordingFile poses = ReadRecordingFile(SourceFile("tests/recordings/bag_none.mcap"), {});
  for (const char* name : {"tf.mcap", "tf.db3", "tf1.bag"}) {
    SCOPED_TRACE(name);
    const std::filesystem::path path = SourceFile(std::string("tests/recordings/") + name);
    const RecordingFile file = ReadRecordingFile(path, {.tf_frame = "cameras"});
    ExpectMadeBag(file);
    const auto bits = [](const RecordingFile& of) {
      return of.markers->positions.unaryExpr([](double x) { return std::isnan(x) ? -1.0 : x; });
    };
    EXPECT_EQ(bits(file), bits(poses));
    EXPECT_EQ(file.markers_start_s, poses.markers_start_s);
    const RecordingFile unasked = ReadRecordingFile(path, {});
    EXPECT_FALSE(unasked.markers.has_value());
    EXPECT_TRUE(unasked.joints.has_value());
    EXPECT_NE(unasked.why_no_markers.find("base_link, cameras, room; give"), std::string::npos)
        << unasked.why_no_markers;
    EXPECT_NE(ReadRecordingFile(path, {.tf_frame = "camera"})
                  .why_no_markers.find("no frame 'camera'; did you mean 'cameras'"),
              std::string::npos);
  }
}

JointLog SomeLog() {
  JointLog log;
  log.names = {"elbow", "wrist"};
  log.time_s = Eigen::VectorXd::LinSpaced(8, 10.0, 10.875);
  log.positions = Eigen::MatrixXd::Random(8, 2);
  log.torques = Eigen::MatrixXd::Random(8, 2);
  return log;
}

TEST(BagsTest, HandMadeBagKeepsEveryBit) {
  const JointLog log = SomeLog();
  const RecordingFile file = ReadBag(McapBytes(log));
  EXPECT_EQ(file.joints->time_s, log.time_s);
  EXPECT_EQ(file.joints->positions, log.positions);
  EXPECT_EQ(file.joints->torques, log.torques);
  EXPECT_FALSE(file.markers.has_value());
}

/// A bag of two topics, made of the records of two bags of one topic.
std::string TwoTopics(const JointLog& a, const JointLog& b, bool one_name) {
  std::string first = McapBytes(a), second = McapBytes(b);
  const std::string topic = Bytes().Text("/joint_states").text;
  std::size_t channel = second.find(topic) - 4;
  second[channel] = 9;  // the number of the channel
  if (!one_name) second.replace(second.find("/joint_states"), 13, "/hand_statess");
  const std::string message("\5", 1);
  // The records from the channel to the end of the data. A message has the channel's number after
  // its head.
  std::size_t at = channel - 9;
  const std::size_t end = second.size() - 8 - 29 - 13;
  std::string records = second.substr(at, end - at);
  for (at = 0; at < records.size();) {
    std::uint64_t length = 0;
    for (int i = 8; i > 0; --i) {
      length = length << 8 | static_cast<unsigned char>(records[at + static_cast<std::size_t>(i)]);
    }
    if (records[at] == 5) records[at + 9] = 9;
    at += 9 + length;
  }
  return first.insert(first.size() - 8 - 29 - 13, records);
}

TEST(BagsTest, OneOfSeveralTopicsIsAskedFor) {
  const JointLog log = SomeLog();
  JointLog hand = SomeLog();
  hand.names = {"thumb", "finger"};
  const std::string bag = TwoTopics(log, hand, false);
  const RecordingFile both = ReadBag(bag);
  EXPECT_FALSE(both.joints.has_value());
  EXPECT_NE(both.why_no_joints.find("/joint_states, /hand_statess"), std::string::npos)
      << both.why_no_joints;
  EXPECT_EQ(ReadBag(bag, {.joints_topic = "/hand_statess"}).joints->names, hand.names);
  EXPECT_FALSE(ReadBag(bag, {.joints_topic = "/no"}).joints.has_value());
  // Two drivers publish on the same topic.
  EXPECT_EQ(ReadBag(TwoTopics(log, hand, true)).joints->names.size(), 4u);
}

/// The log of a topic of joint states with these messages.
JointLog TakeTopic(const std::vector<std::string>& messages) {
  RosMessages topic("bag", {});
  topic.AddTopic(1, "/joint_states", "sensor_msgs/msg/JointState", RosEncoding::kCdr);
  for (const std::string& message : messages) topic.Add(1, message, 0, "");
  return topic.Take().joints.value();
}

/// Some drivers list joints in the order of a hash table, which may change at any time.
TEST(BagsTest, JointsMayComeInAnotherOrder) {
  const JointLog log = SomeLog();
  JointLog turned = log;
  std::swap(turned.names[0], turned.names[1]);
  turned.positions.col(0).swap(turned.positions.col(1));
  turned.torques.col(0).swap(turned.torques.col(1));
  std::vector<std::string> messages;
  for (int i = 0; i < log.sample_count(); ++i) {
    messages.push_back(JointStateCdr(i % 3 == 1 ? turned : log, i));
  }
  const JointLog read = TakeTopic(messages);
  EXPECT_EQ(read.names, log.names);
  EXPECT_EQ(read.time_s, log.time_s);
  EXPECT_EQ(read.positions, log.positions);
  EXPECT_EQ(read.torques, log.torques);
}

/// `ros2 bag record --compression-mode message` compresses each message as a frame of zstd. Here
/// each frame has one uncompressed block.
TEST(BagsTest, MessagesMayBeCompressed) {
  const JointLog log = SomeLog();
  std::vector<std::string> messages;
  for (int i = 0; i < log.sample_count(); ++i) {
    const std::string message = JointStateCdr(log, i);
    Bytes frame;
    frame.U(0xFD2FB528, 4).U(0xA0, 1).U(message.size(), 4).U(message.size() << 3 | 1, 3);
    messages.push_back(frame.text + message);
  }
  const JointLog read = TakeTopic(messages);
  EXPECT_EQ(read.positions, log.positions);
  EXPECT_EQ(read.torques, log.torques);
  messages[3].pop_back();
  ExpectInputError([&] { TakeTopic(messages); }, {"message of '/joint_states'", "zstd"});
}

/// A bag of some rows of a log.
std::string PieceOf(const JointLog& log, Eigen::Index begin, Eigen::Index count) {
  JointLog part = log;
  part.time_s = log.time_s.segment(begin, count);
  part.positions = log.positions.middleRows(begin, count);
  part.torques = log.torques.middleRows(begin, count);
  return McapBytes(part);
}

/// The list that rosbag2 writes of the files of a split bag.
std::string Metadata(const std::string& files) {
  return "rosbag2_bagfile_information:\n  version: 9\n  storage_identifier: mcap\n"
         "  relative_file_paths:\n" +
         files + "  custom_data: ~\n";
}

TEST(BagsTest, FolderOfABagIsOneRecording) {
  const JointLog log = SomeLog();
  const ScratchFolder folder;
  folder.Write("bag_0.mcap", PieceOf(log, 0, 3));
  std::string second = PieceOf(log, 3, 5);
  const std::size_t channel = second.find(Bytes().Text("/joint_states").text) - 4;
  second[channel] = 9;  // rosbag2 numbers topics anew; messages have the new number
  for (std::size_t at = channel - 9; second[at] == 4 || second[at] == 5;) {
    if (second[at] == 5) second[at + 9] = 9;
    at += 9 + static_cast<unsigned char>(second[at + 1]) +
          256u * static_cast<unsigned char>(second[at + 2]);
  }
  folder.Write("bag_1.mcap", second);
  folder.Write("metadata.yaml", Metadata("    - bag_0.mcap\n    - bag_1.mcap.zstd\n"));
  const RecordingFile read = ReadRecordingFile(folder.path(), {});
  EXPECT_EQ(read.joints->time_s, log.time_s);
  EXPECT_EQ(read.joints->positions, log.positions);
  EXPECT_EQ(read.joints->torques, log.torques);
  EXPECT_EQ(read.notes.size(), 1u);  // one for the topic
  EXPECT_EQ(FilesOfRecording(folder.path()),
            (std::vector{folder.path() / "metadata.yaml", folder.path() / "bag_0.mcap",
                         folder.path() / "bag_1.mcap"}));
  folder.Write("metadata.yaml", Metadata("    - bag_0.mcap\n    - bag_2.mcap\n"));
  ExpectInputError([&] { ReadRecordingFile(folder.path(), {}); },
                   {"metadata.yaml:6", "there is no file", "bag_2.mcap"});
  folder.Write("metadata.yaml", Metadata("    - bag_0.mcap\n    - bag_1.mcap\n    - bag_0.mcap\n"));
  ExpectInputError([&] { ReadRecordingFile(folder.path(), {}); },
                   {"metadata.yaml:7", "twice", "bag_0.mcap"});
}

TEST(BagsTest, FolderOfADatabaseIsOneRecording) {
  const ScratchFolder folder;
  folder.Write("bag.db3", ReadFile(SourceFile("tests/recordings/bag.db3")));
  folder.Write("metadata.yaml", Metadata("    - bag.db3\n"));
  ExpectMadeBag(ReadRecordingFile(folder.path(), {}));
}

TEST(BagsTest, FolderIsComparedWithItsMetadata) {
  const JointLog log = SomeLog();
  const ScratchFolder folder;
  folder.Write("bag_0.mcap", PieceOf(log, 0, 3));
  const auto counted = [&](const char* count) {
    folder.Write("metadata.yaml",
                 Metadata("    - bag_0.mcap\n") +
                     "  topics_with_message_count:\n    - topic_metadata: {name: /joint_states}\n"
                     "      message_count: " +
                     count + "\n");
    return ReadRecordingFile(folder.path(), {}).notes.front();
  };
  EXPECT_EQ(counted("3").find("metadata.yaml"), std::string::npos);
  EXPECT_NE(counted("8").find("3 messages; metadata.yaml states 8"), std::string::npos);
  folder.Write("bag_1.mcap", PieceOf(log, 3, 5));
  ExpectInputError([&] { ReadRecordingFile(folder.path(), {}); },
                   {"metadata.yaml:5", "does not list", "bag_1.mcap", "`ros2 bag reindex`"});
}

TEST(BagsTest, FolderWithoutMetadataIsNamed) {
  const ScratchFolder folder;
  folder.Write("bag_1.db3", "");
  ExpectInputError([&] { ReadRecordingFile(folder.path(), {}); }, {"is a folder", "bag_1.db3"});
  folder.Write("bag_0.db3", "");
  ExpectInputError([&] { ReadRecordingFile(folder.path(), {}); },
                   {"bag_0.db3 and so on", "`ros2 bag reindex`"});
}

TEST(BagsTest, WhatIsLeftOfABagIsReadWhereAsked) {
  const JointLog log = SomeLog();
  const std::string good = McapBytes(log);
  for (const std::size_t missing : {45u, 100u}) {  // the end of the data; the last message
    const std::string cut = good.substr(0, good.size() - missing);
    const RecordingFile read = ReadBag(cut, {.salvage = true});
    const Eigen::Index left = missing == 45 ? 8 : 7;
    EXPECT_EQ(read.joints->time_s, log.time_s.head(left));
    EXPECT_EQ(read.joints->positions, log.positions.topRows(left));
    ASSERT_EQ(read.salvaged.size(), 1u);
    EXPECT_NE(read.notes.front().find("of " + std::to_string(cut.size())), std::string::npos);
  }
  EXPECT_TRUE(ReadBag(good, {.salvage = true}).salvaged.empty());
}

TEST(BagsTest, WhatIsLeftOfOtherBagsIsReadWhereAsked) {
  const auto file = [](const char* name) {
    return ReadFile(SourceFile(std::string("tests/recordings/") + name));
  };
  const std::string bag = file("bag1_none.bag");
  const RecordingFile whole = ReadBag(bag, {.salvage = true});
  EXPECT_TRUE(whole.salvaged.empty());
  const RecordingFile cut = ReadBag(bag.substr(0, bag.size() - 3), {.salvage = true});  // cut index
  EXPECT_EQ(cut.joints->positions, whole.joints->positions);
  ASSERT_EQ(cut.salvaged.size(), 1u);
  EXPECT_NE(cut.notes.front().find("up to byte"), std::string::npos) << cut.notes.front();
  // If a recorder crashed, the position of the index is not written.
  std::string open = bag;
  const std::size_t index = bag.find("index_pos=") + 10;
  open.replace(index, 8, 8, '\0');
  ExpectInputError([&] { ReadBag(open); }, {"not closed", "reindex", "--salvage"});
  EXPECT_EQ(ReadBag(open, {.salvage = true}).joints->positions, whole.joints->positions);

  const std::string database = file("bag.db3");
  const JointLog log = ReadBag(database, {.salvage = true}).joints.value();
  EXPECT_TRUE(ReadBag(database, {.salvage = true}).salvaged.empty());
  const std::string torn = database.substr(0, 8 * 1024);  // two of its ten pages are missing
  ExpectInputError([&] { ReadBag(torn); }, {"bag: the database", "cut off", "--salvage"});
  const RecordingFile left = ReadBag(torn, {.salvage = true});
  const Eigen::Index samples = left.joints->sample_count();
  EXPECT_GT(samples, log.sample_count() / 2);
  EXPECT_LT(samples, log.sample_count());
  EXPECT_EQ(left.joints->positions, log.positions.topRows(samples));
  EXPECT_EQ(left.salvaged.size(), 1u);
}

// SQLite reads zeros where the last page ends: messages without numbers, or joints at zero.
TEST(BagsTest, ADatabaseThatIsCutWithinItsLastPageIsNamed) {
  const std::string whole = ReadFile(SourceFile("tests/recordings/bag.db3"));
  const RecordingFile all = ReadBag(whole);
  const ScratchFolder folder;
  for (const std::size_t missing : {20u, 733u}) {
    const std::string cut = whole.substr(0, whole.size() - missing);
    folder.Write("bag.db3", cut);
    ExpectInputError([&] { ReadBag(cut); }, {"bag: the database", "cut off", "--salvage"});
    ExpectInputError([&] { ReadRecordingFile(folder.path() / "bag.db3", {}); }, {"cut off"});
    for (const RecordingFile& left :
         {ReadBag(cut, {.salvage = true}),
          ReadRecordingFile(folder.path() / "bag.db3", {.salvage = true})}) {
      EXPECT_EQ(left.salvaged.size(), 1u);
      const Eigen::Index samples = left.joints->sample_count();
      EXPECT_GT(samples, 5);
      EXPECT_EQ(left.joints->positions, all.joints->positions.topRows(samples));
    }
  }
}

// With write-ahead logging, the last messages are in a file of their own until the recorder closes
// the database.
TEST(BagsTest, ADatabaseWithoutItsFileWalSaysSoAndLeavesNothingBesideIt) {
  std::string bytes = ReadFile(SourceFile("tests/recordings/bag.db3"));
  bytes[18] = bytes[19] = 2;
  const ScratchFolder folder;
  folder.Write("bag.db3", bytes);
  const RecordingFile read = ReadRecordingFile(folder.path() / "bag.db3", {});
  EXPECT_EQ(read.joints->positions,
            ReadRecordingFile(SourceFile("tests/recordings/bag.db3"), {}).joints->positions);
  EXPECT_NE(read.notes.front().find("the last messages are missing"), std::string::npos);
  EXPECT_EQ(CountIn(folder.path()), 1);
}

TEST(BagsTest, DamageIsNamedWithItsPlace) {
  const std::string good = McapBytes(SomeLog());
  ExpectInputError([&] { ReadBag(good.substr(0, good.size() - 45)); }, {"bag: byte", "cut off"});
  ExpectInputError([&] { ReadBag(good.substr(0, good.size() - 100)); },
                   {"bag: byte", "cut off", "--salvage"});
  std::string bad = good;
  bad[bad.find("elbow") - 4] = 100;  // length of the name
  ExpectInputError([&] { ReadBag(bad); },
                   {"bag: byte", "message of '/joint_states'", "ends within"});
  bad = good;
  bad[bad.rfind("elbow") - 8] = 3;  // number of joints
  ExpectInputError([&] { ReadBag(bad); }, {"bag: byte", "/joint_states"});
  const auto damaged = [](const char* name, std::size_t at) {
    std::string bytes = ReadFile(SourceFile(std::string("tests/recordings/") + name));
    bytes[at] = static_cast<char>(bytes[at] ^ 0x55);
    return bytes;
  };
  for (const char* name : {"bag_none.mcap", "bag_lz4.mcap", "bag_zstd.mcap"}) {
    ExpectInputError([&] { ReadBag(damaged(name, 700)); }, {"bag: byte", "damaged"});
  }
  for (const char* name : {"bag1_lz4.bag", "bag1_bz2.bag"}) {
    const std::string bag = ReadFile(SourceFile(std::string("tests/recordings/") + name));
    const std::size_t chunk = bag.find("compression=");
    ExpectInputError([&] { ReadBag(damaged(name, chunk + 60)); }, {"bag: byte", "damaged"});
    ExpectInputError([&] { ReadBag(bag.substr(0, chunk + 300)); }, {"bag: byte", "cut off"});
    ExpectInputError([&] { ReadBag(bag.substr(0, bag.size() - 3)); }, {"bag: byte"});
  }
  const std::string database = ReadFile(SourceFile("tests/recordings/bag.db3"));
  ExpectInputError([&] { ReadBag(database.substr(0, 5000)); }, {"bag:", "database"});
  ExpectInputError([&] { ReadBag(damaged("bag.db3", 100)); }, {"bag:"});
}

}  // namespace
}  // namespace elastocal
