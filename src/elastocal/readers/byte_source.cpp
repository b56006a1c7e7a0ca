// SPDX-License-Identifier: Apache-2.0
#include "elastocal/readers/byte_source.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "elastocal/files/yaml_value.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/read_file.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kStreamBlock = 1u << 18;

[[noreturn]] void FailToOpen(const std::string& name, int reason) {
  if (name.empty()) throw InputError("the name of a file is empty");
  if (reason == ENOENT || reason == ENOTDIR) throw InputError(name + ": there is no such file");
  throw InputError(name + ": cannot be read: " + std::generic_category().message(reason));
}

constexpr const char* kMetadata = "metadata.yaml";

/// Throws InputError for a file of the bag's kind that metadata.yaml does not list, because its
/// contents would be missing.
void RefuseUnlisted(const std::filesystem::path& folder,
                    const std::vector<std::filesystem::path>& pieces, const YamlValue& list) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::filesystem::path& file = entry.path();
    const auto is_piece = [&](const std::filesystem::path& piece) {
      return piece.filename() == file.filename();
    };
    if (file.extension() != pieces.front().extension() || std::ranges::any_of(pieces, is_piece)) {
      continue;
    }
    list.Fail("does not list " + file.string() +
              "; a list of all files of the bag was expected (`ros2 bag reindex` writes one)");
  }
}

/// The files of a bag, by the metadata.yaml in its folder.
std::vector<std::filesystem::path> BagPieces(const std::filesystem::path& folder) {
  const std::filesystem::path metadata = folder / kMetadata;
  const auto list = YamlValue::Parse(ReadFile(metadata), metadata.string())
                        .Get("rosbag2_bagfile_information")
                        .Get("relative_file_paths");
  std::vector<std::filesystem::path> pieces;
  std::error_code error;
  for (const YamlValue& item : list.Items()) {
    std::filesystem::path piece = folder / item.Text();
    // rosbag2 packed the file as a whole, and somebody has unpacked it since.
    if (piece.extension() == ".zstd" && !std::filesystem::exists(piece, error)) {
      piece.replace_extension();
    }
    if (!std::filesystem::is_regular_file(piece, error)) {
      item.Fail("there is no file " + piece.string());
    }
    piece = piece.lexically_normal();
    if (std::ranges::find(pieces, piece) != pieces.end()) {
      item.Fail("lists " + piece.string() + " twice; each file of the bag once was expected");
    }
    pieces.push_back(std::move(piece));
  }
  if (pieces.empty()) list.Fail("found no file; one or more were expected");
  RefuseUnlisted(folder, pieces, list);
  return pieces;
}

/// What to do with a folder of bags that has no metadata.yaml; empty for any other one.
std::string BagInside(const std::filesystem::path& folder) {
  std::vector<std::string> bags;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string ending = entry.path().extension().string();
    if (ending == ".mcap" || ending == ".db3") bags.push_back(entry.path().filename().string());
  }
  if (bags.empty() && std::filesystem::exists(folder / "experiment.yaml", error)) {
    return ": one of those that its experiment.yaml names (it is a recording folder)";
  }
  if (bags.empty()) return "";
  const std::string one = ": the bag in it, " + *std::ranges::min_element(bags);
  return bags.size() == 1 ? one
                          : one +
                                " and so on (a bag in pieces is read with its metadata.yaml, which "
                                "`ros2 bag reindex` writes)";
}

}  // namespace

bool IsBagFolder(const std::filesystem::path& folder) {
  std::error_code error;
  return std::filesystem::is_regular_file(folder / kMetadata, error);
}

std::map<std::string, double> StatedMessages(const std::filesystem::path& folder) {
  std::map<std::string, double> messages;
  if (!IsBagFolder(folder)) return messages;
  const std::filesystem::path metadata = folder / kMetadata;
  const auto topics = YamlValue::Parse(ReadFile(metadata), metadata.string())
                          .Get("rosbag2_bagfile_information")
                          .Find("topics_with_message_count");
  if (!topics) return messages;
  for (const YamlValue& topic : topics->Items()) {
    messages[topic.Get("topic_metadata").Get("name").Text()] = topic.Get("message_count").Number();
  }
  return messages;
}

std::vector<std::filesystem::path> FilesOfRecording(const std::filesystem::path& recording) {
  if (!IsBagFolder(recording)) return {recording};
  std::vector<std::filesystem::path> files = BagPieces(recording);
  files.insert(files.begin(), recording / kMetadata);
  return files;
}

ByteSource ByteSource::Open(const std::filesystem::path& file) {
  if (IsBagFolder(file)) {
    std::vector<std::filesystem::path> pieces = BagPieces(file);
    ByteSource source = Open(pieces.front());
    source.name_ = file.string();
    source.pieces_ = std::move(pieces);
    return source;
  }
  ByteSource source;
  source.name_ = file.string();
  source.path_ = file;
  // O_NONBLOCK: does not wait for somebody at the other end of a pipe.
  const int descriptor = open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) FailToOpen(source.name_, errno);
  source.descriptor_ = std::shared_ptr<const int>(new int(descriptor), [](const int* open_file) {
    close(*open_file);
    delete open_file;
  });
  struct stat status {};
  if (fstat(descriptor, &status) != 0) FailToOpen(source.name_, errno);
  if (S_ISDIR(status.st_mode)) {
    throw InputError(source.name_ + ": is a folder; a file was expected" + BagInside(file));
  }
  if (!S_ISREG(status.st_mode)) {
    throw InputError(source.name_ + ": is not a regular file (a device or a pipe)");
  }
  source.size_ = static_cast<std::uint64_t>(status.st_size);
  return source;
}

ByteSource ByteSource::OfMemory(std::string_view bytes, std::string name) {
  ByteSource source;
  source.name_ = std::move(name);
  source.memory_ = bytes;
  source.size_ = bytes.size();
  return source;
}

std::size_t ByteSource::Read(std::uint64_t offset, std::span<char> to) const {
  if (offset >= size_) return 0;
  const auto most = static_cast<std::size_t>(std::min<std::uint64_t>(to.size(), size_ - offset));
  if (!descriptor_) {
    std::memcpy(to.data(), memory_.data() + offset, most);
    return most;
  }
  std::size_t held = 0;
  while (held < most) {
    const ssize_t count =
        pread(*descriptor_, to.data() + held, most - held, static_cast<off_t>(offset + held));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) FailToOpen(name_, errno);
    if (count == 0) break;  // it was made shorter meanwhile
    held += static_cast<std::size_t>(count);
  }
  return held;
}

void ByteSource::ReadAll(std::uint64_t offset, std::span<char> to, const std::string& what) const {
  const std::size_t count = Read(offset, to);
  if (count == to.size()) return;
  Fail(size_, "the file ends within " + what + " (" + std::to_string(to.size()) +
                  " bytes from byte " + std::to_string(offset) + " on were expected)");
}

void ByteSource::Fail(std::uint64_t offset, const std::string& message) const {
  throw InputError(name_ + ": byte " + std::to_string(offset) + ": " + message);
}

SourceStream::SourceStream(const ByteSource& source)
    : std::istream(static_cast<std::streambuf*>(this)), source_(source), block_(kStreamBlock) {}

std::streambuf::int_type SourceStream::underflow() {
  const std::size_t count = source_.Read(offset_, block_);
  if (count == 0) return std::streambuf::traits_type::eof();
  offset_ += count;
  setg(block_.data(), block_.data(), block_.data() + count);
  return std::streambuf::traits_type::to_int_type(block_[0]);
}

}  // namespace elastocal
