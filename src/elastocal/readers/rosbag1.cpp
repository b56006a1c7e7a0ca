// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <map>

#include "elastocal/math/input_error.hpp"
#include "elastocal/readers/formats.hpp"
#include "elastocal/readers/record_fields.hpp"
#include "elastocal/readers/ros_messages.hpp"
#include "elastocal/readers/unpack.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr std::string_view kBagMagic = "#ROSBAG V2.0\n";
constexpr const char* kSalvage = "; `elastocal convert --salvage` takes what is before";

/// What stands in the head of a record: `name=value`, values as bytes.
class BagHeader {
 public:
  BagHeader(const ByteSource& source, std::uint64_t offset, std::span<const char> bytes)
      : source_(source), offset_(offset) {
    RecordFields fields(source, offset, bytes);
    while (!fields.Rest().empty()) {
      const std::string field = fields.Text();
      const std::size_t equals = field.find('=');
      if (equals == std::string::npos) source.Fail(offset, "a field of the record has no name");
      values_[field.substr(0, equals)] = field.substr(equals + 1);
    }
  }

  std::string Text(const std::string& name) const {
    const auto found = values_.find(name);
    if (found == values_.end()) source_.Fail(offset_, "the record has no field " + Quote(name));
    return found->second;
  }
  std::uint64_t Number(const std::string& name, std::size_t width) const {
    const std::string bytes = Text(name);
    return RecordFields(source_, offset_, bytes).Number(width);
  }

 private:
  const ByteSource& source_;
  std::uint64_t offset_;
  std::map<std::string, std::string> values_;
};

/// Records of a bag of ROS 1, from the first to the last chunk. Its index is not needed.
class Rosbag1Reader {
 public:
  Rosbag1Reader(const ByteSource& source, const ReaderOptions& options)
      : source_(source), messages_(source.name(), options) {}

  RecordingFile Read(bool salvage) {
    std::uint64_t at = kBagMagic.size();
    std::vector<std::string> salvaged;
    while (at < source_.size()) {
      if (salvage && !IsWhole(at)) {
        salvaged.push_back(source_.name() +
                           " was not closed, or was cut off: it is read up to byte " +
                           std::to_string(at) + " of " + std::to_string(source_.size()));
        break;
      }
      ReadPart(at, head_, "the head of a record");
      const BagHeader header(source_, at, head_);
      const std::uint64_t data = at + 4 + head_.size();
      const std::uint64_t kind = header.Number("op", 1);
      if (kind == kBag && header.Number("index_pos", 8) == 0 && !salvage) {
        source_.Fail(at,
                     std::string("the bag was not closed; `rosbag reindex` mends it") + kSalvage);
      }
      if (kind == kChunk || kind == kConnection || kind == kMessage) {
        ReadPart(data, data_, std::string("a record (the bag was cut off") + kSalvage + ")");
        Take(kind, header, data_, at);
      }
      at = data + 4 + Length(data);
      if (at > source_.size())
        source_.Fail(source_.size(), std::string("the bag ends within a record") + kSalvage);
    }
    RecordingFile file = messages_.Take();
    file.notes.insert(file.notes.begin(), salvaged.begin(), salvaged.end());
    file.salvaged = std::move(salvaged);
    return file;
  }

 private:
  enum Kind : std::uint64_t { kMessage = 2, kBag = 3, kChunk = 5, kConnection = 7 };

  /// Whether a record's head and data are there.
  bool IsWhole(std::uint64_t at) const {
    for (int part = 0; part < 2; ++part) {
      if (source_.size() - at < 4) return false;
      const std::uint64_t length = Length(at);
      if (length > source_.size() - at - 4) return false;
      at += 4 + length;
    }
    return true;
  }

  std::uint64_t Length(std::uint64_t at) const {
    std::array<char, 4> bytes{};
    source_.ReadAll(at, bytes,
                    std::string("the length of a record (the bag was cut off") + kSalvage + ")");
    return RecordFields(source_, at, bytes).Number(4);
  }

  /// A length and so many bytes.
  void ReadPart(std::uint64_t at, std::vector<char>& to, const std::string& what) const {
    const std::uint64_t length = Length(at);
    if (length > kLargestChunk) source_.Fail(at, "a record of more than 512 MiB");
    if (length > source_.size() - at) source_.Fail(at, "the file ends within " + what);
    to.resize(static_cast<std::size_t>(length));
    source_.ReadAll(at + 4, to, what);
  }

  void Take(std::uint64_t kind, const BagHeader& header, std::span<const char> data,
            std::uint64_t offset) {
    if (kind == kConnection) {
      const BagHeader connection(source_, offset, data);
      messages_.AddTopic(header.Number("conn", 4), header.Text("topic"), connection.Text("type"),
                         RosEncoding::kRos1);
    } else if (kind == kMessage) {
      const std::string time = header.Text("time");
      RecordFields fields(source_, offset, time);
      const std::uint64_t seconds = fields.Number(4), nanoseconds = fields.Number(4);
      messages_.Add(header.Number("conn", 4), data,
                    static_cast<std::int64_t>(seconds * 1000000000 + nanoseconds),
                    "byte " + std::to_string(offset) + ": ");
    } else {
      TakeChunk(header, data, offset);
    }
  }

  void TakeChunk(const BagHeader& header, std::span<const char> packed, std::uint64_t offset) {
    const std::string compression = header.Text("compression");
    const std::uint64_t size = header.Number("size", 4);
    if (size > kLargestChunk) source_.Fail(offset, "a chunk of more than 512 MiB");
    std::span<const char> records = packed;
    if (compression == "lz4" || compression == "bz2") {
      const auto unpack = compression == "lz4" ? UnpackLz4 : UnpackBz2;
      const bool fine = unpack(packed, static_cast<std::size_t>(size), chunk_);
      if (!fine) {
        source_.Fail(offset, "the chunk is damaged: its " + compression +
                                 " data end early, or are of more bytes than it says");
      }
      records = chunk_;
    } else if (compression != "none") {
      source_.Fail(offset, "the compression " + Quote(compression) +
                               " is not known; none, lz4 or bz2 was expected");
    }
    if (records.size() != size) {
      source_.Fail(offset, "the chunk is damaged: its size is not what it says");
    }
    RecordFields fields(source_, offset, records);
    while (!fields.Rest().empty()) {
      const BagHeader inner(source_, offset, fields.Take(fields.Number(4)));
      const std::span<const char> data = fields.Take(fields.Number(4));
      const std::uint64_t kind = inner.Number("op", 1);
      if (kind == kConnection || kind == kMessage) Take(kind, inner, data, offset);
    }
  }

  const ByteSource& source_;
  RosMessages messages_;
  std::vector<char> head_, data_, chunk_;
};

}  // namespace

bool IsRosbag1(std::string_view head) { return head.starts_with(kBagMagic); }

RecordingFile ReadRosbag1(const ByteSource& source, const ReaderOptions& options) {
  return Rosbag1Reader(source, options).Read(options.salvage);
}

}  // namespace elastocal
