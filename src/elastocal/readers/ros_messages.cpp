// SPDX-License-Identifier: Apache-2.0
#include "elastocal/readers/ros_messages.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/utf8.hpp"
#include "elastocal/readers/body_track.hpp"
#include "elastocal/readers/byte_source.hpp"
#include "elastocal/readers/cdr.hpp"
#include "elastocal/readers/joint_columns.hpp"
#include "elastocal/readers/joint_series.hpp"
#include "elastocal/readers/record_fields.hpp"
#include "elastocal/readers/unpack.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr std::int64_t kSecond = 1000000000;

/// The stamp of a header, ns; 0 if it was not set. `frame` gets the name of its frame.
std::int64_t ReadStamp(MessageFields& fields, RosEncoding encoding, std::string* frame = nullptr) {
  if (encoding == RosEncoding::kRos1) fields.U32();  // the sequence number
  const std::int64_t seconds =
      encoding == RosEncoding::kRos1 ? static_cast<std::int64_t>(fields.U32()) : fields.I32();
  const std::int64_t stamp = seconds * kSecond + fields.U32();
  std::string name = fields.Text();
  if (frame != nullptr) *frame = std::move(name);
  return stamp;
}

/// "/vrpn/LHAND/pose" -> "LHAND".
std::string BodyName(std::string topic) {
  constexpr std::string_view kEnding = "/pose";
  if (topic.ends_with(kEnding) && topic.size() > kEnding.size() + 1) {
    topic.resize(topic.size() - kEnding.size());
  }
  return topic.substr(topic.rfind('/') + 1);
}

/// Position of each of `wanted` in `names`, which has the same names in any order.
std::vector<std::size_t> PlacesIn(const std::vector<std::string>& names,
                                  const std::vector<std::string>& wanted) {
  std::vector<std::size_t> places(names.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  if (names == wanted) return places;
  std::map<std::string_view, std::size_t> place_of;
  for (std::size_t i = 0; i < names.size(); ++i) place_of[names[i]] = i;
  std::ranges::transform(wanted, places.begin(),
                         [&](const std::string& name) { return place_of.at(name); });
  return places;
}

}  // namespace

RosMessages::RosMessages(std::string source, const ReaderOptions& options)
    : source_(std::move(source)),
      wanted_topic_(options.joints_topic),
      transforms_(options.tf_frame, options.tf_bodies) {}

bool RosMessages::AddTopic(std::uint64_t id, const std::string& name, const std::string& type,
                           RosEncoding encoding) {
  RequireUtf8(name + type, source_);
  const auto known = std::ranges::find_if(topics_, [&](const Topic& one) {
    return one.name == name && one.type == type && one.encoding == encoding;
  });
  const auto [place, added] =
      places_.emplace(id, static_cast<std::size_t>(known - topics_.begin()));
  if (!added && place->second != static_cast<std::size_t>(known - topics_.begin())) {
    throw InputError(source_ + ": the topics " + Quote(topics_[place->second].name) + " and " +
                     Quote(name) + " have the same number");
  }
  if (known != topics_.end()) return known->kind != Kind::kOther;
  Topic& topic = topics_.emplace_back();
  topic.name = name;
  topic.type = type;
  topic.encoding = encoding;
  if (type == "sensor_msgs/msg/JointState" || type == "sensor_msgs/JointState") {
    if (wanted_topic_.empty() || wanted_topic_ == name) topic.kind = Kind::kJointState;
  }
  if (type == "geometry_msgs/msg/PoseStamped" || type == "geometry_msgs/PoseStamped") {
    topic.kind = Kind::kPose;
  }
  if (type == "tf2_msgs/msg/TFMessage" || type == "tf2_msgs/TFMessage" || type == "tf/tfMessage") {
    topic.kind = Kind::kTransforms;
  }
  return topic.kind != Kind::kOther;
}

void RosMessages::Add(std::uint64_t id, std::span<const char> message, std::int64_t received_ns,
                      const std::string& place) {
  const auto found = places_.find(id);
  if (found == places_.end()) {
    throw InputError(source_ + ": " + place + "a message of topic number " + std::to_string(id) +
                     ", which is not listed above it");
  }
  Topic& topic = topics_[found->second];
  ++topic.messages;
  const std::string where = source_ + ": " + place + "message of " + Quote(topic.name) + ": ";
  // By `ros2 bag record --compression-mode message`; CDR begins with a zero.
  constexpr std::string_view kZstd = "\x28\xB5\x2F\xFD";
  if (topic.kind != Kind::kOther && topic.encoding == RosEncoding::kCdr &&
      std::string_view(message.data(), message.size()).starts_with(kZstd)) {
    if (!UnpackZstd(message, kLargestChunk, unpacked_)) {
      throw InputError(where + "its zstd data are damaged, or are of more than 512 MiB");
    }
    message = unpacked_;
  }
  if (topic.kind == Kind::kJointState) AddJointState(topic, message, received_ns, where);
  if (topic.kind == Kind::kPose) AddPose(topic, message, received_ns, where);
  if (topic.kind == Kind::kTransforms) AddTransforms(topic, message, received_ns, where);
}

void RosMessages::AddJointState(Topic& topic, std::span<const char> message,
                                std::int64_t received_ns, const std::string& place) {
  MessageFields fields(message, topic.encoding == RosEncoding::kCdr, place);
  const std::int64_t stamp = ReadStamp(fields, topic.encoding);
  const std::vector<std::string> names = fields.Texts();
  const std::vector<double> positions = fields.Numbers();
  fields.Numbers();  // velocities
  std::vector<double> efforts = fields.Numbers();
  if (positions.empty()) return;  // the driver sends only velocities
  if (positions.size() != names.size() || (!efforts.empty() && efforts.size() != names.size())) {
    throw InputError(place + std::to_string(names.size()) + " names, " +
                     std::to_string(positions.size()) + " positions and " +
                     std::to_string(efforts.size()) + " efforts");
  }
  topic.unstamped += stamp == 0 ? 1 : 0;
  JointGroup& group = GroupOf(topic, names, place);
  efforts.resize(names.size(), kNaN);
  group.stamps_ns.push_back(stamp);
  group.received_ns.push_back(received_ns);
  for (const std::size_t i : PlacesIn(names, group.names)) {
    group.positions.push_back(positions[i]);
    group.efforts.push_back(efforts[i]);
  }
}

/// The group with these joints, in whatever order: some drivers list joints in the order of a hash
/// table.
RosMessages::JointGroup& RosMessages::GroupOf(Topic& topic, const std::vector<std::string>& names,
                                              const std::string& place) const {
  std::vector<JointGroup>& groups = topic.groups;
  const auto same = std::ranges::find(groups, names, &JointGroup::names);
  if (same != groups.end()) return *same;
  const std::set<std::string> joints(names.begin(), names.end());
  const auto turned = std::ranges::find_if(groups, [&](const JointGroup& one) {
    return one.names.size() == names.size() && joints.size() == names.size() &&
           std::ranges::all_of(one.names, [&](const auto& name) { return joints.contains(name); });
  });
  if (turned != groups.end()) return *turned;
  constexpr std::size_t kMostGroups = 100;
  if (groups.size() == kMostGroups) {
    throw InputError(place + "its joints are different ones in too many messages");
  }
  for (const std::string& name : names) RequireUtf8(name, source_);
  if (joints.size() != names.size()) {
    throw InputError(place + "a joint comes twice");
  }
  groups.push_back({names, {}, {}, {}, {}});
  return groups.back();
}

void RosMessages::AddPose(Topic& topic, std::span<const char> message, std::int64_t received_ns,
                          const std::string& place) {
  MessageFields fields(message, topic.encoding == RosEncoding::kCdr, place);
  const std::int64_t stamp = ReadStamp(fields, topic.encoding);
  topic.unstamped += stamp == 0 ? 1 : 0;
  topic.stamps_ns.push_back(stamp);
  topic.received_ns.push_back(received_ns);
  for (int i = 0; i < 7; ++i) topic.poses.push_back(fields.F64());
}

void RosMessages::AddTransforms(const Topic& topic, std::span<const char> message,
                                std::int64_t received_ns, const std::string& place) {
  constexpr std::size_t kLeastBytes = 70;  // of one transform: stamp, two names, seven numbers
  MessageFields fields(message, topic.encoding == RosEncoding::kCdr, place);
  const bool is_static = topic.name.ends_with("tf_static");
  for (std::uint32_t left = fields.Count(kLeastBytes); left > 0; --left) {
    StampedTransform transform;
    transform.received_ns = received_ns;
    transform.stamp_ns = ReadStamp(fields, topic.encoding, &transform.parent);
    transform.child = fields.Text();
    for (double& number : transform.pose) number = fields.F64();
    RequireUtf8(transform.parent + transform.child, source_);
    transforms_.Add(transform, is_static, place);
  }
}

void RosMessages::TakeTimes(Topic& topic, std::vector<std::string>& notes) const {
  std::string note = "topic " + topic.name + " (" + topic.type +
                     "): " + std::to_string(topic.messages) + " messages";
  // A clock of a simulation may begin at 0.
  if (topic.unstamped > 1 && topic.unstamped < topic.messages) {
    throw InputError(source_ + ": topic " + Quote(topic.name) + ": " +
                     std::to_string(topic.unstamped) + " of " + std::to_string(topic.messages) +
                     " messages have no stamp");
  }
  if (topic.unstamped > 1) {
    note += ", without stamps: their time is when they were received";
    topic.stamps_ns = topic.received_ns;
    for (JointGroup& group : topic.groups) group.stamps_ns = group.received_ns;
  }
  notes.push_back(std::move(note));
}

RecordingFile RosMessages::Take() {
  RecordingFile file;
  const std::map<std::string, double> stated = StatedMessages(source_);
  for (Topic& topic : topics_) {
    TakeTimes(topic, file.notes);
    const auto count = stated.find(topic.name);
    if (topic.kind == Kind::kOther || count == stated.end()) continue;
    if (count->second != static_cast<double>(topic.messages)) {
      file.notes.back() += "; metadata.yaml states " + FormatNumber(count->second);
    }
  }
  TakeJoints(file);
  TakePoses(file);
  if (!file.joints || !file.markers) file.markers_start_s.reset();
  return file;
}

void RosMessages::TakeJoints(RecordingFile& file) {
  std::vector<Topic*> topics;
  std::string names;
  for (Topic& topic : topics_) {
    if (topic.kind != Kind::kJointState || topic.groups.empty()) continue;
    topics.push_back(&topic);
    names += (names.empty() ? "" : ", ") + topic.name;
  }
  if (topics.empty()) {
    file.why_no_joints = "it has no joint states" +
                         (wanted_topic_.empty() ? "" : " in the topic " + Quote(wanted_topic_));
    return;
  }
  if (topics.size() > 1) {
    file.why_no_joints = "it has joint states in several topics: " + names +
                         "; give one of them: joints_topic of the trial in experiment.yaml, or "
                         "the option --topic";
    return;
  }
  std::vector<JointSeries> all;
  for (JointGroup& group : topics[0]->groups) {
    all.push_back(SortSeries(source_ + ": topic " + Quote(topics[0]->name) + ": ", group.names,
                             group.stamps_ns, group.positions, group.efforts));
    group = {};
  }
  file.joints = MergeSeries(source_, all, file.notes);
  CheckJointLog(*file.joints);
}

std::vector<BodyTrack> RosMessages::PoseTracks() {
  std::vector<BodyTrack> tracks;
  std::multiset<std::string> short_names;
  for (const Topic& topic : topics_) {
    if (topic.kind == Kind::kPose) short_names.insert(BodyName(topic.name));
  }
  for (Topic& topic : topics_) {
    if (topic.kind != Kind::kPose || topic.stamps_ns.empty()) continue;
    const std::string name = BodyName(topic.name);
    tracks.push_back({short_names.count(name) == 1 ? name : topic.name, std::move(topic.stamps_ns),
                      std::move(topic.poses)});
  }
  return tracks;
}

void RosMessages::TakePoses(RecordingFile& file) {
  std::vector<BodyTrack> tracks = PoseTracks();
  if (!transforms_.empty() && (transforms_.asked() || tracks.empty())) {
    tracks = transforms_.Take(source_, file.why_no_markers);
  } else if (!transforms_.empty()) {
    file.notes.emplace_back(
        "its tf is not read, because it has geometry_msgs/PoseStamped (to read "
        "it: tf_frame)");
  } else if (tracks.empty()) {
    file.why_no_markers = "it has no poses (geometry_msgs/PoseStamped, tf2_msgs/TFMessage)";
  }
  if (tracks.empty()) return;
  const RegularPoses regular = ResampleTracks(source_, std::move(tracks));
  file.markers = MarkerTrajectories{source_, {}, regular.rate_hz, {}};
  AddBodies(regular.poses, *file.markers, file.notes);
  file.markers_start_s = static_cast<double>(regular.start_ns) / kSecond;
}

}  // namespace elastocal
