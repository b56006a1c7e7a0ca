// SPDX-License-Identifier: Apache-2.0
#include "elastocal/readers/c3d_parameters.hpp"

#include <array>
#include <bit>
#include <cctype>
#include <cstdint>
#include <cstdlib>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/utf8.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kC3dBlock = 512;
constexpr std::size_t kMostRecords = 20000;

std::uint16_t Bits16(const char* bytes, C3dProcessor processor) {
  const auto a = static_cast<unsigned char>(bytes[0]), b = static_cast<unsigned char>(bytes[1]);
  const bool big = processor == C3dProcessor::kMips;
  return static_cast<std::uint16_t>(big ? a << 8 | b : b << 8 | a);
}

int SignedByte(char byte) { return std::bit_cast<std::int8_t>(byte); }

/// Reads the records of the section one after the other.
class SectionReader {
 public:
  explicit SectionReader(const ByteSource& source) : source_(source) {}

  C3dParameters Read() {
    std::array<char, 4> head{};
    source_.ReadAll(0, {head.data(), 2}, "the header");
    at_ = kC3dBlock * (static_cast<std::uint64_t>(static_cast<unsigned char>(head[0])) - 1);
    source_.ReadAll(at_, head, "the head of the parameter section");
    const int processor = static_cast<unsigned char>(head[3]);
    if (processor < 84 || processor > 86) {
      source_.Fail(at_ + 3, "found the processor type " + std::to_string(processor) +
                                "; 84 (Intel), 85 (DEC) or 86 (MIPS) was expected");
    }
    parameters_.processor = static_cast<C3dProcessor>(processor);
    at_ += 4;
    for (std::size_t i = 0; i < kMostRecords && ReadRecord(); ++i) {
    }
    Resolve();
    return std::move(parameters_);
  }

 private:
  struct Record {
    int group;
    std::string name;
    C3dParameter parameter;
  };

  /// False for the end of the section.
  bool ReadRecord() {
    std::array<char, 2> head{};
    source_.ReadAll(at_, head, "the parameter section");
    const int length = std::abs(SignedByte(head[0]));
    const int group = SignedByte(head[1]);
    if (length == 0 || group == 0) return false;
    std::vector<char> text(static_cast<std::size_t>(length) + 2);
    source_.ReadAll(at_ + 2, text, "the name of a parameter");
    std::string name;
    for (int i = 0; i < length; ++i) {
      name += static_cast<char>(std::toupper(static_cast<unsigned char>(text[i])));
    }
    const std::uint64_t pointer = at_ + 2 + static_cast<std::uint64_t>(length);
    const std::uint16_t step =
        Bits16(&text[static_cast<std::size_t>(length)], parameters_.processor);
    if (step != 0 && step < 2) source_.Fail(pointer, "the next parameter begins within this one");
    if (group < 0) {
      groups_[-group] = name;
    } else {
      records_.push_back({group, name, ReadValues(pointer + 2, name)});
    }
    at_ = pointer + step;
    return step != 0;
  }

  C3dParameter ReadValues(std::uint64_t at, const std::string& name) {
    C3dParameter parameter;
    std::array<char, 2> head{};
    const std::string what = "parameter " + Printable(name);
    source_.ReadAll(at, head, what);
    const int type = SignedByte(head[0]);
    const auto dimensions = static_cast<std::size_t>(static_cast<unsigned char>(head[1]));
    if ((type != -1 && type != 1 && type != 2 && type != 4) || dimensions > 7) {
      source_.Fail(at, what + ": found type " + std::to_string(type) + " with " +
                           std::to_string(dimensions) +
                           " dimensions; -1, 1, 2 or 4 with at most 7 was expected");
    }
    std::vector<char> sizes(dimensions);
    source_.ReadAll(at + 2, sizes, what);
    std::size_t count = 1;
    for (const char size : sizes) {
      count *= static_cast<unsigned char>(size);
      if (count > 1u << 24) source_.Fail(at + 2, what + " is too large");
    }
    parameter.offset = at + 2 + dimensions;
    const std::size_t width = type == -1 ? 1 : static_cast<std::size_t>(type);
    if (parameter.offset + count * width > source_.size()) {
      source_.Fail(parameter.offset, "the file ends within " + what);
    }
    std::vector<char> bytes(count * width);
    source_.ReadAll(parameter.offset, bytes, what);
    parameter.integers = type == 2;
    if (type == -1) {
      const std::size_t length =
          sizes.empty() ? 1 : static_cast<std::size_t>(static_cast<unsigned char>(sizes[0]));
      SplitTexts(bytes, length, parameter.texts);
      return parameter;
    }
    for (std::size_t i = 0; i < count; ++i) {
      const char* const from = &bytes[i * width];
      parameter.numbers.push_back(type == 1   ? static_cast<unsigned char>(*from)
                                  : type == 2 ? C3dInteger(from, parameters_.processor)
                                              : C3dReal(from, parameters_.processor));
    }
    return parameter;
  }

  static void SplitTexts(const std::vector<char>& bytes, std::size_t length,
                         std::vector<std::string>& texts) {
    for (std::size_t i = 0; length > 0 && i + length <= bytes.size(); i += length) {
      std::string text(&bytes[i], length);
      text = text.substr(0, text.find('\0'));
      texts.emplace_back(Trim(text));
    }
  }

  /// Groups may stand below their parameters.
  void Resolve() {
    for (Record& record : records_) {
      const auto group = groups_.find(record.group);
      if (group == groups_.end()) continue;
      parameters_.values.emplace(group->second + ":" + record.name, std::move(record.parameter));
    }
  }

  const ByteSource& source_;
  std::uint64_t at_ = 0;
  C3dParameters parameters_;
  std::map<int, std::string> groups_;
  std::vector<Record> records_;
};

}  // namespace

std::int16_t C3dInteger(const char* bytes, C3dProcessor processor) {
  return static_cast<std::int16_t>(Bits16(bytes, processor));
}

float C3dReal(const char* bytes, C3dProcessor processor) {
  const std::uint32_t first = Bits16(bytes, processor), second = Bits16(bytes + 2, processor);
  switch (processor) {
    case C3dProcessor::kIntel:
      return std::bit_cast<float>(second << 16 | first);
    case C3dProcessor::kMips:
      return std::bit_cast<float>(first << 16 | second);
    case C3dProcessor::kDec:
      break;
  }
  // VAX F: the halves exchanged, the exponent larger by 2. With exponent 0 it is zero, whatever
  // the fraction.
  if ((first & 0x7F80u) == 0) return 0.0f;
  const std::uint32_t bits = first << 16 | second;
  if ((first & 0x7F80u) <= 0x0100u) return std::bit_cast<float>(bits & 0x80000000u);
  return std::bit_cast<float>(bits - 0x01000000u);
}

C3dParameters ReadC3dParameters(const ByteSource& source) { return SectionReader(source).Read(); }

const C3dParameter* C3dParameters::Find(const std::string& name) const {
  const auto found = values.find(name);
  return found == values.end() ? nullptr : &found->second;
}

std::string C3dParameters::Text(const std::string& name) const {
  const C3dParameter* const found = Find(name);
  if (!found || found->texts.empty()) return "";
  // A list of letters, each by itself, is one text.
  std::string text;
  if (found->texts[0].size() <= 1) {
    for (const std::string& letter : found->texts) text += letter;
    return text;
  }
  return found->texts[0];
}

double C3dParameters::Unsigned(const std::string& name, double otherwise, std::size_t i) const {
  const C3dParameter* const found = Find(name);
  if (!found || found->numbers.size() <= i) return otherwise;
  const double number = found->numbers[i];
  constexpr double kTurn = 65536.0;
  return found->integers && number < 0.0 ? number + kTurn : number;
}

}  // namespace elastocal
