// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "elastocal/readers/byte_source.hpp"

namespace elastocal {

/// Reads the fields of a record of a bag, one after the other; numbers are little-endian. Throws
/// InputError naming the record's offset if the record ends too early.
class RecordFields {
 public:
  RecordFields(const ByteSource& source, std::uint64_t offset, std::span<const char> bytes)
      : source_(source), offset_(offset), bytes_(bytes) {}

  std::uint64_t Number(std::size_t width) {
    const std::span<const char> from = Take(width);
    std::uint64_t number = 0;
    for (std::size_t i = width; i-- > 0;) {
      number = number << 8 | static_cast<unsigned char>(from[i]);
    }
    return number;
  }
  /// A text with its length of four bytes before it.
  std::string Text() {
    const auto text = Take(Number(4));
    return {text.begin(), text.end()};
  }
  std::span<const char> Take(std::uint64_t count) {
    if (count > bytes_.size()) source_.Fail(offset_, "the record ends within its fields");
    const auto taken = bytes_.first(static_cast<std::size_t>(count));
    bytes_ = bytes_.subspan(taken.size());
    return taken;
  }
  std::span<const char> Rest() const { return bytes_; }

 private:
  const ByteSource& source_;
  std::uint64_t offset_;
  std::span<const char> bytes_;
};

/// The largest chunk and the largest message that are read.
constexpr std::size_t kLargestChunk = 512u << 20;

}  // namespace elastocal
