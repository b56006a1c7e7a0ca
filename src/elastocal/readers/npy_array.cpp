// SPDX-License-Identifier: Apache-2.0
#include "elastocal/readers/npy_array.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstring>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/utf8.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kMostNumbers = 1u << 27;
constexpr std::size_t kLongestHeader = 1u << 16;

struct NpyType {
  bool big_endian = false;
  char kind = 0;          ///< f, i, u, b, U or S
  std::size_t width = 0;  ///< bytes of an element
};

struct NpyHeader {
  NpyType type;
  bool columns_first = false;
  std::vector<std::size_t> shape;
};

class NpyReader {
 public:
  NpyReader(const ReadBytes& read, const std::string& place) : read_(read), place_(place) {}

  NpyArray Read(const std::vector<std::size_t>* wanted) {
    const NpyHeader header = ReadHeader();
    NpyArray array;
    array.shape = header.shape;
    if (wanted && *wanted != array.shape) return array;
    array.is_text = header.type.kind == 'U' || header.type.kind == 'S';
    std::size_t count = 1;
    for (const std::size_t length : header.shape) {
      if (length != 0 && count > kMostNumbers / length) Fail("more than 2^27 elements");
      count *= length;
    }
    if (count * header.type.width > (std::uint64_t{1} << 31)) Fail("more than 2 GiB");
    ReadElements(header.type, count, array);
    if (header.columns_first && header.shape.size() == 2) Transpose(array);
    if (header.columns_first && header.shape.size() > 2) {
      Fail("more than two dimensions in Fortran's order");
    }
    return array;
  }

 private:
  [[noreturn]] void Fail(const std::string& message) const { throw InputError(place_ + message); }

  void ReadAll(std::span<char> to, const char* what) const {
    if (read_(to) != to.size()) Fail(std::string("the array ends within ") + what);
  }

  NpyHeader ReadHeader() const {
    std::array<char, 8> magic{};
    ReadAll(magic, "its head");
    constexpr std::string_view kMagic("\x93NUMPY", 6);
    if (std::string_view(magic.data(), 6) != kMagic) Fail("is no array of NumPy");
    std::array<char, 4> length{};
    ReadAll({length.data(), magic[6] == 1 ? 2u : 4u}, "its head");
    std::size_t bytes = 0;
    for (std::size_t i = 4; i-- > 0;) bytes = bytes << 8 | static_cast<unsigned char>(length[i]);
    if (bytes > kLongestHeader) Fail("its head has " + std::to_string(bytes) + " bytes");
    std::string text(bytes, '\0');
    ReadAll(text, "its head");
    return ParseHeader(text);
  }

  /// {'descr': '<f8', 'fortran_order': False, 'shape': (3, 4), }
  NpyHeader ParseHeader(const std::string& text) const {
    NpyHeader header;
    const std::string_view type = Value(text, "descr");
    const std::size_t end = type.size() > 1 ? type.find('\'', 1) : std::string::npos;
    if (type.empty() || type[0] != '\'' || end == std::string_view::npos || end < 3) {
      Fail("its elements have fields; numbers or texts were expected");
    }
    header.type = ParseType(type.substr(1, end - 1));
    header.columns_first = Value(text, "fortran_order").starts_with("True");
    std::string_view shape = Value(text, "shape");
    const std::size_t close = shape.find(')');
    if (!shape.starts_with('(') || close == std::string_view::npos)
      Fail("its shape cannot be read");
    shape = shape.substr(1, close - 1);
    while (!shape.empty()) {
      const std::size_t comma = std::min(shape.find(','), shape.size());
      const std::string_view part = Trim(shape.substr(0, comma));
      shape.remove_prefix(std::min(comma + 1, shape.size()));
      if (part.empty()) continue;
      const auto number = ParseNumber(part);
      if (!number || *number < 0.0 || *number > 1e9 || header.shape.size() > 8) {
        Fail("its shape cannot be read");
      }
      header.shape.push_back(static_cast<std::size_t>(*number));
    }
    return header;
  }

  static std::string_view Value(std::string_view text, const std::string& key) {
    const std::size_t at = text.find("'" + key + "'");
    if (at == std::string_view::npos) return {};
    const std::size_t colon = text.find(':', at);
    if (colon == std::string_view::npos) return {};
    return Trim(text.substr(colon + 1));
  }

  NpyType ParseType(std::string_view text) const {
    NpyType type;
    type.big_endian = text[0] == '>';
    type.kind = text[1];
    const double width = ParseNumber(text.substr(2)).value_or(0.0);
    const auto is = [&](std::string_view kinds, std::initializer_list<double> widths) {
      return kinds.find(type.kind) != std::string_view::npos &&
             std::find(widths.begin(), widths.end(), width) != widths.end();
    };
    const bool text_type = (type.kind == 'U' || type.kind == 'S') && width >= 0 && width <= 4096;
    if (std::string_view("<>|=").find(text[0]) == std::string_view::npos ||
        (!is("f", {4, 8}) && !is("iu", {1, 2, 4, 8}) && !is("b", {1}) && !text_type)) {
      Fail("its elements are of type " + Quote(text) +
           "; floats of 4 or 8 bytes, integers or texts were expected");
    }
    type.width = static_cast<std::size_t>(width) * (type.kind == 'U' ? 4 : 1);
    return type;
  }

  /// In pieces, so that memory grows with what is there and not with what the head claims.
  void ReadElements(const NpyType& type, std::size_t count, NpyArray& array) const {
    if (type.width == 0) {
      array.texts.resize(std::min<std::size_t>(count, kLongestHeader));
      return;
    }
    const std::size_t piece = std::max<std::size_t>(1, (1u << 20) / type.width);
    std::vector<char> bytes(piece * type.width);
    for (std::size_t done = 0; done < count; done += piece) {
      const std::size_t now = std::min(piece, count - done);
      ReadAll({bytes.data(), now * type.width}, "its elements");
      for (std::size_t i = 0; i < now; ++i) {
        const char* const from = &bytes[i * type.width];
        if (array.is_text) {
          array.texts.push_back(Text(from, type));
        } else {
          array.numbers.push_back(Number(from, type));
        }
      }
    }
  }

  static std::uint64_t Bits(const char* from, std::size_t width, bool big_endian) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < width; ++i) {
      bits = bits << 8 | static_cast<unsigned char>(from[big_endian ? i : width - 1 - i]);
    }
    return bits;
  }

  static double Number(const char* from, const NpyType& type) {
    const std::uint64_t bits = Bits(from, type.width, type.big_endian);
    if (type.kind == 'f' && type.width == 8) return std::bit_cast<double>(bits);
    if (type.kind == 'f') return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    if (type.kind != 'i') return static_cast<double>(bits);
    const unsigned shift = 64 - 8 * static_cast<unsigned>(type.width);
    return static_cast<double>(static_cast<std::int64_t>(bits << shift) >> shift);
  }

  static std::string Text(const char* from, const NpyType& type) {
    std::string text;
    if (type.kind == 'S') {
      text.assign(from, type.width);
      return text.substr(0, text.find('\0'));
    }
    for (std::size_t i = 0; i < type.width; i += 4) {
      const auto code = static_cast<std::uint32_t>(Bits(from + i, 4, type.big_endian));
      if (code == 0) break;
      AppendUtf8(code, text);
    }
    return text;
  }

  static void AppendUtf8(std::uint32_t code, std::string& text) {
    const auto add = [&](std::uint32_t byte) { text += static_cast<char>(byte); };
    if (code < 0x80) return add(code);
    if (code < 0x800) {
      add(0xC0 | code >> 6);
    } else if (code < 0x10000) {
      add(0xE0 | code >> 12);
      add(0x80 | (code >> 6 & 0x3F));
    } else {
      add(0xF0 | (code >> 18 & 0x07));
      add(0x80 | (code >> 12 & 0x3F));
      add(0x80 | (code >> 6 & 0x3F));
    }
    add(0x80 | (code & 0x3F));
  }

  static void Transpose(NpyArray& array) {
    const std::size_t rows = array.shape[0], columns = array.shape[1];
    std::vector<double> numbers(array.numbers.size());
    for (std::size_t i = 0; i < array.numbers.size(); ++i) {
      numbers[i % rows * columns + i / rows] = array.numbers[i];
    }
    array.numbers = std::move(numbers);
  }

  const ReadBytes& read_;
  const std::string& place_;
};

}  // namespace

std::size_t NpyArray::count() const { return is_text ? texts.size() : numbers.size(); }

NpyArray ReadNpy(const ReadBytes& read, const std::string& place,
                 const std::vector<std::size_t>* wanted) {
  return NpyReader(read, place).Read(wanted);
}

}  // namespace elastocal
