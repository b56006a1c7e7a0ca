// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "elastocal/readers/frame_transforms.hpp"
#include "elastocal/readers/recording_file.hpp"

namespace elastocal {

/// Encoding of the fields of messages.
enum class RosEncoding { kCdr, kRos1 };

/// Collects the messages of a bag that a calibration can use: joint states, and poses of bodies
/// (stamped poses or transforms of tf). The readers of all kinds of bags add them in the order of
/// the file. Bodies of tf are taken if there are no stamped poses, or if the options name a frame.
class RosMessages {
 public:
  /// `source` names the bag in messages.
  RosMessages(std::string source, const ReaderOptions& options);

  /// Begins another file of the same recording, which numbers its topics anew.
  void BeginPiece() { places_.clear(); }

  /// Adds a topic with the number `id` in the bag; false if its messages are not needed. Types are
  /// named as in ROS 1 or ROS 2. A topic with the name and type of an earlier one is the same
  /// topic.
  bool AddTopic(std::uint64_t id, const std::string& name, const std::string& type,
                RosEncoding encoding);

  /// Adds a message of a topic that was added (others are passed over), with the time when it was
  /// received. `place` is the beginning of messages about it: "byte 123: ".
  void Add(std::uint64_t id, std::span<const char> message, std::int64_t received_ns,
           const std::string& place);

  /// The recording in all messages. Throws InputError: implausible times, names that change.
  RecordingFile Take();

 private:
  enum class Kind { kOther, kJointState, kPose, kTransforms };

  /// Messages of one topic with the same joints, in the order in which the first one has them.
  struct JointGroup {
    std::vector<std::string> names;
    std::vector<std::int64_t> stamps_ns, received_ns;
    std::vector<double> positions, efforts;  ///< message after message
  };
  struct Topic {
    std::string name;
    std::string type;
    Kind kind = Kind::kOther;
    RosEncoding encoding = RosEncoding::kCdr;
    std::size_t messages = 0, unstamped = 0;
    std::vector<JointGroup> groups;                    ///< of joint states
    std::vector<std::int64_t> stamps_ns, received_ns;  ///< of poses
    std::vector<double> poses;                         ///< x y z, quaternion x y z w
  };

  void AddJointState(Topic& topic, std::span<const char> message, std::int64_t received_ns,
                     const std::string& place);
  JointGroup& GroupOf(Topic& topic, const std::vector<std::string>& names,
                      const std::string& place) const;
  void AddPose(Topic& topic, std::span<const char> message, std::int64_t received_ns,
               const std::string& place);
  void AddTransforms(const Topic& topic, std::span<const char> message, std::int64_t received_ns,
                     const std::string& place);
  /// Replaces the stamps of a topic without stamps by the times when its messages were received.
  void TakeTimes(Topic& topic, std::vector<std::string>& notes) const;
  void TakeJoints(RecordingFile& file);
  void TakePoses(RecordingFile& file);
  std::vector<BodyTrack> PoseTracks();

  std::string source_;
  std::string wanted_topic_;
  std::vector<Topic> topics_;
  std::map<std::uint64_t, std::size_t> places_;  ///< in `topics_`, by the number in the bag
  FrameTransforms transforms_;
  std::vector<char> unpacked_;
};

}  // namespace elastocal
