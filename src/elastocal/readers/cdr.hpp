// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "elastocal/math/input_error.hpp"

namespace elastocal {

/// Reads the fields of a message one after the other, in CDR of DDS (ROS 2; both byte orders,
/// versions 1 and 2) or in the format of ROS 1. Throws InputError beginning with `place` if the
/// message ends too early.
class MessageFields {
 public:
  MessageFields(std::span<const char> bytes, bool cdr, std::string place)
      : bytes_(bytes), cdr_(cdr), place_(std::move(place)) {
    if (cdr) ReadEncapsulation();
  }

  std::uint32_t U32() { return static_cast<std::uint32_t>(Bits(4)); }
  std::int32_t I32() { return static_cast<std::int32_t>(U32()); }
  double F64() { return std::bit_cast<double>(Bits(8)); }

  std::string Text() {
    const std::uint32_t length = U32();
    const std::span<const char> text = Take(length);
    std::string value(text.begin(), text.end());
    // CDR counts the NUL at the end.
    if (cdr_ && !value.empty() && value.back() == '\0') value.pop_back();
    return value;
  }

  /// Reads the length of a list whose items have at least `least_bytes` bytes each.
  std::uint32_t Count(std::size_t least_bytes) {
    const std::uint32_t count = U32();
    if (count > (bytes_.size() - at_) / least_bytes) {
      Fail("a list of " + std::to_string(count) + " items is longer than the message");
    }
    return count;
  }

  std::vector<std::string> Texts() {
    const std::uint32_t count = Count(4);
    std::vector<std::string> texts;
    for (std::uint32_t i = 0; i < count; ++i) texts.push_back(Text());
    return texts;
  }

  std::vector<double> Numbers() {
    const std::uint32_t count = Count(8);
    std::vector<double> numbers;
    numbers.reserve(count);
    for (std::uint32_t i = 0; i < count; ++i) numbers.push_back(F64());
    return numbers;
  }

 private:
  void ReadEncapsulation() {
    const std::span<const char> head = Take(4);
    const int kind = static_cast<unsigned char>(head[1]);
    if (head[0] != 0 || (kind != 0 && kind != 1 && kind != 6 && kind != 7)) {
      Fail("its encapsulation is not plain CDR (kind " + std::to_string(kind) + ")");
    }
    big_endian_ = kind == 0 || kind == 6;
    widest_ = kind >= 6 ? 4 : 8;
    bytes_ = bytes_.subspan(4);
    at_ = 0;
  }

  std::uint64_t Bits(std::size_t width) {
    if (cdr_) {
      const std::size_t step = std::min(width, widest_);
      Take((step - at_ % step) % step);
    }
    const std::span<const char> from = Take(width);
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < width; ++i) {
      bits = bits << 8 | static_cast<unsigned char>(from[big_endian_ ? i : width - 1 - i]);
    }
    return bits;
  }

  std::span<const char> Take(std::size_t count) {
    if (count > bytes_.size() - at_) {
      Fail("the message ends within its fields (" + std::to_string(bytes_.size()) + " bytes)");
    }
    const std::span<const char> taken = bytes_.subspan(at_, count);
    at_ += count;
    return taken;
  }

  [[noreturn]] void Fail(const std::string& message) const { throw InputError(place_ + message); }

  std::span<const char> bytes_;
  bool cdr_, big_endian_ = false;
  std::size_t widest_ = 8, at_ = 0;
  std::string place_;
};

}  // namespace elastocal
