// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <map>
#include <optional>

#include <zlib.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/readers/formats.hpp"
#include "elastocal/readers/record_fields.hpp"
#include "elastocal/readers/ros_messages.hpp"
#include "elastocal/readers/unpack.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr std::string_view kMcapMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kRecordHead = 9;
constexpr std::string_view kNotClosed =
    "the bag was not closed, or was cut off; `elastocal convert --salvage` takes what is before";

/// Records of MCAP, from the first to the end of the data, chunk by chunk.
class McapReader {
 public:
  McapReader(const ByteSource& source, RosMessages& messages)
      : source_(source), messages_(messages) {}

  /// The byte where the file ends too early, if it does and `salvage` takes that.
  std::optional<std::uint64_t> Read(bool salvage) {
    std::uint64_t at = kMcapMagic.size();
    while (!done_) {
      std::array<char, kRecordHead> head{};
      const bool is_there = source_.Read(at, head) == head.size();
      const auto [kind, length] = Head(head);
      if (!is_there || length > source_.size() - at - kRecordHead) {
        if (salvage) return at;
        source_.Fail(at, "the file ends within the record that begins here (" +
                             std::string(kNotClosed) + ")");
      }
      if (Needed(kind)) {
        if (length > kLargestChunk) source_.Fail(at, "a record of more than 512 MiB");
        record_.resize(static_cast<std::size_t>(length));
        source_.ReadAll(at + kRecordHead, record_, "a record");
        Take(kind, record_, at, false);
      }
      at += kRecordHead + length;
    }
    return std::nullopt;
  }

 private:
  enum Kind : unsigned char {
    kFooter = 2,
    kSchema = 3,
    kChannel = 4,
    kMessage = 5,
    kChunk = 6,
    kDataEnd = 15
  };

  static std::pair<unsigned char, std::uint64_t> Head(std::span<const char> bytes) {
    std::uint64_t length = 0;
    for (std::size_t i = kRecordHead - 1; i > 0; --i) {
      length = length << 8 | static_cast<unsigned char>(bytes[i]);
    }
    return {static_cast<unsigned char>(bytes[0]), length};
  }

  bool Needed(unsigned char kind) {
    done_ = kind == kDataEnd || kind == kFooter;
    return kind >= kSchema && kind <= kChunk;
  }

  void Take(unsigned char kind, std::span<const char> bytes, std::uint64_t offset, bool in_chunk) {
    RecordFields fields(source_, offset, bytes);
    if (kind == kSchema) {
      const std::uint64_t id = fields.Number(2);
      schemas_[id] = fields.Text();
    } else if (kind == kChannel) {
      TakeChannel(fields, offset);
    } else if (kind == kMessage) {
      const std::uint64_t channel = fields.Number(2);
      fields.Number(4);  // the sequence number
      const std::uint64_t received = fields.Number(8);
      fields.Number(8);  // when it was published
      messages_.Add(channel, fields.Rest(), static_cast<std::int64_t>(received & INT64_MAX),
                    "byte " + std::to_string(offset) + (in_chunk ? " (chunk): " : ": "));
    } else if (kind == kChunk) {
      if (in_chunk) source_.Fail(offset, "a chunk within a chunk");
      TakeChunk(fields, offset);
    }
  }

  void TakeChannel(RecordFields& fields, std::uint64_t offset) {
    const std::uint64_t id = fields.Number(2), schema = fields.Number(2);
    const std::string topic = fields.Text(), encoding = fields.Text();
    const auto type = schemas_.find(schema);
    if (schema != 0 && type == schemas_.end()) {
      source_.Fail(offset, "the channel of topic " + Quote(topic) + " has the unknown schema " +
                               std::to_string(schema));
    }
    const bool known = encoding == "cdr" || encoding == "ros1";
    messages_.AddTopic(id, topic,
                       !known        ? "encoding " + encoding
                       : schema == 0 ? "no schema"
                                     : type->second,
                       encoding == "ros1" ? RosEncoding::kRos1 : RosEncoding::kCdr);
  }

  void TakeChunk(RecordFields& fields, std::uint64_t offset) {
    fields.Number(8);  // times of the first and last message
    fields.Number(8);
    const std::uint64_t size = fields.Number(8), checksum = fields.Number(4);
    const std::string compression = fields.Text();
    const std::span<const char> packed = fields.Take(fields.Number(8));
    if (size > kLargestChunk) source_.Fail(offset, "a chunk of more than 512 MiB");
    std::span<const char> records = packed;
    if (compression == "lz4" || compression == "zstd") {
      Unpack(compression, packed, static_cast<std::size_t>(size), offset);
      records = chunk_;
    } else if (!compression.empty()) {
      source_.Fail(offset, "the compression " + Quote(compression) +
                               " is not known; lz4 or zstd was expected");
    }
    const auto found = crc32_z(0, reinterpret_cast<const Bytef*>(records.data()), records.size());
    if (records.size() != size || (checksum != 0 && checksum != found)) {
      source_.Fail(offset, "the chunk is damaged: its " +
                               std::string(records.size() != size ? "size" : "checksum") +
                               " is not what it says");
    }
    while (!records.empty()) {
      if (records.size() < kRecordHead) source_.Fail(offset, "the chunk ends within a record");
      const auto [kind, length] = Head(records);
      records = records.subspan(kRecordHead);
      if (length > records.size()) source_.Fail(offset, "the chunk ends within a record");
      Take(kind, records.first(static_cast<std::size_t>(length)), offset, true);
      records = records.subspan(static_cast<std::size_t>(length));
    }
  }

  void Unpack(const std::string& compression, std::span<const char> packed, std::size_t size,
              std::uint64_t offset) {
    const auto unpack = compression == "lz4" ? UnpackLz4 : UnpackZstd;
    if (unpack(packed, size, chunk_)) return;
    source_.Fail(offset, "the chunk is damaged: its " + compression +
                             " data end early, or are of more bytes than it says");
  }

  const ByteSource& source_;
  RosMessages& messages_;
  std::map<std::uint64_t, std::string> schemas_;
  std::vector<char> record_, chunk_;
  bool done_ = false;
};

}  // namespace

bool IsMcap(std::string_view head) { return head.starts_with(kMcapMagic); }

RecordingFile ReadMcap(const ByteSource& source, const ReaderOptions& options) {
  RosMessages messages(source.name(), options);
  std::vector<std::string> salvaged;
  ForEachPiece(source, [&](const ByteSource& piece) {
    messages.BeginPiece();
    const auto end = McapReader(piece, messages).Read(options.salvage);
    if (!end) return;
    salvaged.push_back(piece.name() + " was not closed, or was cut off: it is read up to byte " +
                       std::to_string(*end) + " of " + std::to_string(piece.size()));
  });
  RecordingFile file = messages.Take();
  file.notes.insert(file.notes.begin(), salvaged.begin(), salvaged.end());
  file.salvaged = std::move(salvaged);
  return file;
}

}  // namespace elastocal
