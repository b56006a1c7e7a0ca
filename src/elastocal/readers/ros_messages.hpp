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

/// How the fields of messages stand one after the other.
enum class RosEncoding { kCdr, kRos1 };

/// The messages of a bag that a calibration can use: joint states, and poses of bodies, stamped or
/// as transforms (tf). Any kind of bag adds them in the order of the file. Bodies of tf are taken
/// where there are no stamped poses, or where the options name a frame.
class RosMessages {
 public:
  /// `source` names the bag in messages.
  RosMessages(std::string source, const ReaderOptions& options);

  /// Another file of the same recording follows, which numbers its topics anew.
  void BeginPiece() { places_.clear(); }

  /// A topic under the number `id` of the bag; false where its messages are not needed. Types are
  /// named as in ROS 1 or ROS 2. What has the name and the type of a topic is that topic.
  bool AddTopic(std::uint64_t id, const std::string& name, const std::string& type,
                RosEncoding encoding);

  /// A message of such a topic (others are passed over), and when it was received. `place` is put
  /// before what is wrong with it: "byte 123: ".
  void Add(std::uint64_t id, std::span<const char> message, std::int64_t received_ns,
           const std::string& place);

  /// What they hold together. Throws InputError: times that make no sense, names that change.
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
  /// Of a topic that nobody stamped, the times when it was received.
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
