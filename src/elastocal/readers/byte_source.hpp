// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <istream>
#include <map>
#include <memory>
#include <span>
#include <streambuf>
#include <string>
#include <string_view>
#include <vector>

namespace elastocal {

/// The bytes of a file or of a text in memory. They are read only where they are asked for, so that
/// a large file takes no more memory than the data that are kept.
class ByteSource {
 public:
  /// Opens a file, or the bag in a folder (IsBagFolder): the source is then the bag's first piece,
  /// and `pieces` has all of them. Throws InputError naming the file: it does not exist, is no
  /// regular file, or cannot be read.
  static ByteSource Open(const std::filesystem::path& file);
  /// The bytes must outlive the source; `name` stands for the file in messages.
  static ByteSource OfMemory(std::string_view bytes, std::string name);

  std::uint64_t size() const { return size_; }
  const std::string& name() const { return name_; }
  /// The path of a file; empty for bytes in memory, which `memory` then has.
  const std::filesystem::path& path() const { return path_; }
  std::string_view memory() const { return memory_; }
  /// The files of a bag's folder that hold one recording together. Empty for any other source.
  const std::vector<std::filesystem::path>& pieces() const { return pieces_; }

  /// Reads from `offset` on, at most to the end; gives the number of bytes read.
  std::size_t Read(std::uint64_t offset, std::span<char> to) const;
  /// Reads all of `to`. Throws InputError naming the offset if the source ends before; `what` says
  /// what is being read.
  void ReadAll(std::uint64_t offset, std::span<char> to, const std::string& what) const;

  /// Throws InputError: "NAME: byte OFFSET: MESSAGE".
  [[noreturn]] void Fail(std::uint64_t offset, const std::string& message) const;

 private:
  ByteSource() = default;

  std::string name_;
  std::filesystem::path path_;
  std::vector<std::filesystem::path> pieces_;
  std::shared_ptr<const int> descriptor_;
  std::string_view memory_;
  std::uint64_t size_ = 0;
};

/// Whether `ros2 bag record` wrote this folder: it holds a metadata.yaml.
bool IsBagFolder(const std::filesystem::path& folder);

/// Number of messages of each topic by metadata.yaml in the folder of a bag; empty if it states
/// none, or if this is no such folder.
std::map<std::string, double> StatedMessages(const std::filesystem::path& folder);

/// The files that are read for a recording: the file itself, or those in the folder of a bag.
std::vector<std::filesystem::path> FilesOfRecording(const std::filesystem::path& recording);

/// Calls `read` with each piece of a bag's folder, or with any other source itself.
template <typename Read>
void ForEachPiece(const ByteSource& source, const Read& read) {
  if (source.pieces().empty()) read(source);
  for (const auto& piece : source.pieces()) read(ByteSource::Open(piece));
}

/// A ByteSource as a stream that is read from beginning to end. The source must outlive it.
class SourceStream : private std::streambuf, public std::istream {
 public:
  explicit SourceStream(const ByteSource& source);

 private:
  std::streambuf::int_type underflow() override;

  const ByteSource& source_;
  std::uint64_t offset_ = 0;
  std::vector<char> block_;
};

}  // namespace elastocal
