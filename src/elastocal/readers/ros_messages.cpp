// SPDX-License-Identifier: Apache-2.0
#include "elastocal/readers/ros_messages.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/utf8.hpp"
#include "elastocal/readers/body_track.hpp"
#include "elastocal/readers/cdr.hpp"
#include "elastocal/readers/joint_columns.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr std::int64_t kSecond = 1000000000;
constexpr double kLongestHole = 0.1;  // s: positions are not interpolated over more

/// The stamp of a header, ns; 0 where nobody set it. `frame` gets the name of its frame.
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

/// Of messages with the same names: sorted by time, repeated ones once.
struct JointSeries {
  std::vector<std::string> names;
  std::vector<std::int64_t> stamps_ns;
  Eigen::MatrixXd positions, efforts;  ///< messages x joints
};

/// Value of a column of `series` at a time, linear between messages; NaN in holes and outside.
double ValueAt(const JointSeries& series, const Eigen::MatrixXd& values, Eigen::Index column,
               std::int64_t time) {
  const auto& stamps = series.stamps_ns;
  const auto after = std::lower_bound(stamps.begin(), stamps.end(), time);
  if (after == stamps.end()) return kNaN;
  const auto i = after - stamps.begin();
  if (*after == time) return values(i, column);
  if (i == 0) return kNaN;
  const double step = static_cast<double>(*after - after[-1]);
  if (step > kLongestHole * kSecond) return kNaN;
  const double share = static_cast<double>(time - after[-1]) / step;
  return (1.0 - share) * values(i - 1, column) + share * values(i, column);
}

}  // namespace

RosMessages::RosMessages(std::string source, const ReaderOptions& options)
    : source_(std::move(source)),
      wanted_topic_(options.joints_topic),
      transforms_(options.tf_frame, options.tf_bodies) {}

bool RosMessages::AddTopic(std::uint64_t id, const std::string& name, const std::string& type,
                           RosEncoding encoding) {
  RequireUtf8(name + type, source_);
  Topic& topic = topics_[id];
  if (!topic.name.empty() && (topic.name != name || topic.type != type)) {
    throw InputError(source_ + ": the topics " + Quote(topic.name) + " and " + Quote(name) +
                     " have the same number");
  }
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
  const auto found = topics_.find(id);
  if (found == topics_.end()) {
    throw InputError(source_ + ": " + place + "a message of topic number " + std::to_string(id) +
                     ", which is not listed above it");
  }
  Topic& topic = found->second;
  ++topic.messages;
  const std::string where = source_ + ": " + place + "message of " + Quote(topic.name) + ": ";
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
  if (positions.empty()) return;  // of a driver that tells velocities only
  if (positions.size() != names.size() || (!efforts.empty() && efforts.size() != names.size())) {
    throw InputError(place + std::to_string(names.size()) + " names, " +
                     std::to_string(positions.size()) + " positions and " +
                     std::to_string(efforts.size()) + " efforts");
  }
  topic.unstamped += stamp == 0 ? 1 : 0;
  auto group = std::find_if(topic.groups.begin(), topic.groups.end(),
                            [&](const JointGroup& one) { return one.names == names; });
  if (group == topic.groups.end()) {
    constexpr std::size_t kMostGroups = 100;
    if (topic.groups.size() == kMostGroups) {
      throw InputError(place + "its names are different in too many messages");
    }
    for (const std::string& name : names) RequireUtf8(name, source_);
    if (std::set<std::string>(names.begin(), names.end()).size() != names.size()) {
      throw InputError(place + "a joint comes twice");
    }
    topic.groups.push_back({names, {}, {}, {}, {}});
    group = topic.groups.end() - 1;
  }
  efforts.resize(names.size(), kNaN);
  group->stamps_ns.push_back(stamp);
  group->received_ns.push_back(received_ns);
  group->positions.insert(group->positions.end(), positions.begin(), positions.end());
  group->efforts.insert(group->efforts.end(), efforts.begin(), efforts.end());
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
  constexpr std::size_t kLeastBytes = 70;  // of one: stamp, two names, seven numbers
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

namespace {

/// In the order of time. A message that comes twice counts once.
JointSeries SortSeries(const std::string& place, std::vector<std::string> names,
                       const std::vector<std::int64_t>& stamps,
                       const std::vector<double>& positions, const std::vector<double>& efforts) {
  const std::size_t width = names.size();
  std::vector<std::size_t> order(stamps.size()), kept;
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return stamps[a] < stamps[b]; });
  const auto at = [&](std::size_t i) {
    return positions.begin() + static_cast<std::ptrdiff_t>(i * width);
  };
  for (const std::size_t i : order) {
    if (kept.empty() || stamps[kept.back()] != stamps[i]) {
      kept.push_back(i);
    } else if (!std::equal(at(i), at(i) + static_cast<std::ptrdiff_t>(width), at(kept.back()))) {
      throw InputError(place + "two messages of the time " +
                       FormatNumber(static_cast<double>(stamps[i]) / kSecond) +
                       " s have different positions");
    }
  }
  JointSeries series;
  series.names = std::move(names);
  const auto rows = static_cast<Eigen::Index>(kept.size());
  series.positions.resize(rows, static_cast<Eigen::Index>(width));
  series.efforts.resizeLike(series.positions);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const std::size_t i = kept[static_cast<std::size_t>(row)];
    series.stamps_ns.push_back(stamps[i]);
    for (std::size_t k = 0; k < width; ++k) {
      series.positions(row, static_cast<Eigen::Index>(k)) = positions[i * width + k];
      series.efforts(row, static_cast<Eigen::Index>(k)) = efforts[i * width + k];
    }
  }
  return series;
}

/// One log: the messages with the most joints give the times; joints that only others have are
/// interpolated at these times, and rows where that is not possible are left out.
JointLog MergeSeries(const std::string& source, const std::vector<JointSeries>& all,
                     std::vector<std::string>& notes) {
  const auto first = std::max_element(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return a.names.size() * a.stamps_ns.size() < b.names.size() * b.stamps_ns.size();
  });
  JointLog log;
  log.source = source;
  std::vector<std::pair<const JointSeries*, Eigen::Index>> columns;
  std::set<std::string> taken;
  const auto add = [&](const JointSeries& series) {
    for (std::size_t k = 0; k < series.names.size(); ++k) {
      if (!taken.insert(series.names[k]).second) continue;
      log.names.push_back(series.names[k]);
      columns.emplace_back(&series, static_cast<Eigen::Index>(k));
    }
  };
  add(*first);
  for (const JointSeries& series : all) add(series);
  const auto width = static_cast<Eigen::Index>(columns.size());
  const auto samples = static_cast<Eigen::Index>(first->stamps_ns.size());
  log.time_s.resize(samples);
  log.positions.resize(samples, width);
  log.torques.resize(samples, width);
  Eigen::Index row = 0;
  for (const std::int64_t stamp : first->stamps_ns) {
    log.time_s[row] = static_cast<double>(stamp) / kSecond;
    for (Eigen::Index k = 0; k < width; ++k) {
      const auto& [series, column] = columns[static_cast<std::size_t>(k)];
      log.positions(row, k) = ValueAt(*series, series->positions, column, stamp);
      log.torques(row, k) = ValueAt(*series, series->efforts, column, stamp);
    }
    if (!log.positions.row(row).array().isNaN().any()) ++row;
  }
  log.time_s.conservativeResize(row);
  log.positions.conservativeResize(row, width);
  log.torques.conservativeResize(row, width);
  if (all.size() > 1) {
    notes.push_back("messages have different joints (" + std::to_string(all.size()) +
                    " sets of them); they are brought to the times of one set, and " +
                    std::to_string(samples - row) + " of " + std::to_string(samples) +
                    " samples are left out where others are not known");
  }
  return log;
}

}  // namespace

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
  for (auto& [id, topic] : topics_) TakeTimes(topic, file.notes);
  TakeJoints(file);
  TakePoses(file);
  if (!file.joints || !file.markers) file.markers_start_s.reset();
  return file;
}

void RosMessages::TakeJoints(RecordingFile& file) {
  std::vector<Topic*> topics;
  std::string names;
  for (auto& [id, topic] : topics_) {
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
  for (const auto& [id, topic] : topics_) {
    if (topic.kind == Kind::kPose) short_names.insert(BodyName(topic.name));
  }
  for (auto& [id, topic] : topics_) {
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
