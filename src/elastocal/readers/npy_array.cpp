// SPDX-License-Identifier: Apache-2.0
#include "elastocal/readers/npy_array.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstring>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/utf8.hpp"
#include "elastocal/readers/times.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kMostNumbers = 1u << 27;
constexpr std::size_t kLongestHeader = 1u << 16;
constexpr std::size_t kLargestRecord = 1u << 20;

struct NpyType {
  bool big_endian = false;
  char kind = 0;          ///< f, i, u, b, U or S
  std::size_t width = 0;  ///< bytes of an element
  std::string unit;       ///< of times, which are of kind i
};

/// A field of records; without a name: bytes that mean nothing.
struct NpyField {
  std::string name;
  NpyType type;
  std::vector<std::size_t> shape;
  std::size_t count = 1;
};

struct NpyHeader {
  NpyType type;
  std::vector<NpyField> fields;  ///< of records; else none
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
    for (const NpyField& field : header.fields) {
      if (field.name.empty()) continue;
      array.field_names.push_back(field.name);
    }
    if (wanted && *wanted != array.shape) return array;
    array.is_text = header.type.kind == 'U' || header.type.kind == 'S';
    array.unit = header.type.unit;
    std::size_t count = 1;
    for (const std::size_t length : header.shape) {
      if (length != 0 && count > kMostNumbers / length) Fail("more than 2^27 elements");
      count *= length;
    }
    if (count * header.type.width > (std::uint64_t{1} << 31)) Fail("more than 2 GiB");
    if (!header.fields.empty()) {
      ReadRecords(header, count, array);
      return array;
    }
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
    if (type.starts_with('[')) {
      ParseFields(type.substr(1), header);
      ParseShape(text, header);
      return header;
    }
    const std::size_t end = type.size() > 1 ? type.find('\'', 1) : std::string::npos;
    if (type.empty() || type[0] != '\'' || end == std::string_view::npos || end < 3) {
      Fail("the type of its elements cannot be read; numbers, texts or records were expected");
    }
    header.type = ParseType(type.substr(1, end - 1));
    if (header.type.kind == 'V') Fail("its elements are bytes that mean nothing");
    ParseShape(text, header);
    return header;
  }

  void ParseShape(const std::string& text, NpyHeader& header) const {
    header.columns_first = Value(text, "fortran_order").starts_with("True");
    header.shape = ParseLengths(Value(text, "shape"));
  }

  /// (3, 4)
  std::vector<std::size_t> ParseLengths(std::string_view shape) const {
    std::vector<std::size_t> lengths;
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
      if (!number || *number < 0.0 || *number > 1e9 || lengths.size() > 8) {
        Fail("its shape cannot be read");
      }
      lengths.push_back(static_cast<std::size_t>(*number));
    }
    return lengths;
  }

  /// 'time', '<f8'), ('q', '<f8', (3,)), ('', '|V4')]: of each field the name, type and perhaps
  /// shape.
  void ParseFields(std::string_view text, NpyHeader& header) const {
    constexpr std::size_t kMostFields = 10000;
    const auto next_text = [&] {
      text = Trim(text);
      const char quote = text.empty() ? ' ' : text[0];
      const std::size_t end =
          quote == '\'' || quote == '"' ? text.find(quote, 1) : std::string_view::npos;
      if (end == std::string_view::npos)
        Fail("its records have fields within fields, or cannot be read");
      const std::string_view found = text.substr(1, end - 1);
      text = Trim(text.substr(end + 1));
      return found;
    };
    while (!(text = Trim(text)).starts_with(']')) {
      if (!text.starts_with('(') || header.fields.size() == kMostFields) {
        Fail("the fields of its records cannot be read");
      }
      text.remove_prefix(1);
      NpyField field;
      field.name = next_text();
      if (!text.starts_with(',')) Fail("the fields of its records cannot be read");
      text.remove_prefix(1);
      field.type = ParseType(next_text());
      if (field.type.kind == 'V') field.name.clear();
      if (text.starts_with(',')) {
        text = Trim(text.substr(1));
        field.shape = ParseLengths(text);
        text.remove_prefix(text.find(')') + 1);
      }
      for (const std::size_t length : field.shape) {
        field.count *= length;
        if (length > kLongestHeader || field.count > kLongestHeader) Fail("a field is too large");
      }
      text = Trim(text);
      if (!text.starts_with(')')) Fail("the fields of its records cannot be read");
      text = Trim(text.substr(1));
      if (text.starts_with(',')) text.remove_prefix(1);
      header.type.width += field.type.width * field.count;
      if (header.type.width > kLargestRecord) Fail("its records have more than 1 MiB each");
      header.fields.push_back(std::move(field));
    }
  }

  static std::string_view Value(std::string_view text, const std::string& key) {
    const std::size_t at = text.find("'" + key + "'");
    if (at == std::string_view::npos) return {};
    const std::size_t colon = text.find(':', at);
    if (colon == std::string_view::npos) return {};
    return Trim(text.substr(colon + 1));
  }

  /// "M8[ns]" and "m8[ns]" are 8-byte integers that count a unit.
  static bool ParseTimes(std::string_view text, NpyType& type) {
    if (!text.starts_with("M8[") && !text.starts_with("m8[")) return false;
    type.unit = text.substr(3, text.find(']') - 3);
    type.kind = 'i';
    type.width = 8;
    return SecondsIn(type.unit) > 0.0;
  }

  NpyType ParseType(std::string_view text) const {
    NpyType type;
    type.big_endian = text[0] == '>';
    if (ParseTimes(text.substr(1), type)) return type;
    type.kind = text[1];
    const double width = ParseNumber(text.substr(2)).value_or(0.0);
    const auto is = [&](std::string_view kinds, std::initializer_list<double> widths) {
      return kinds.find(type.kind) != std::string_view::npos &&
             std::find(widths.begin(), widths.end(), width) != widths.end();
    };
    const bool text_type = (type.kind == 'U' || type.kind == 'S') && width >= 0 && width <= 4096;
    const bool padding = type.kind == 'V' && width > 0 && width <= kLongestHeader;
    if (text.size() < 3 || std::string_view("<>|=").find(text[0]) == std::string_view::npos ||
        (!is("f", {4, 8}) && !is("iu", {1, 2, 4, 8}) && !is("b", {1}) && !text_type && !padding)) {
      Fail("its elements are of type " + Quote(text) +
           "; floats of 4 or 8 bytes, integers, texts or times in s, ms, us or ns were expected");
    }
    type.width = static_cast<std::size_t>(width) * (type.kind == 'U' ? 4 : 1);
    return type;
  }

  void ReadRecords(const NpyHeader& header, std::size_t count, NpyArray& array) const {
    if (header.shape.size() != 1) Fail("its records have several dimensions; a list was expected");
    std::vector<NpyArray> fields(header.fields.size());
    for (std::size_t f = 0; f < fields.size(); ++f) {
      const NpyField& field = header.fields[f];
      fields[f].shape = header.shape;
      fields[f].shape.insert(fields[f].shape.end(), field.shape.begin(), field.shape.end());
      fields[f].is_text = field.type.kind == 'U' || field.type.kind == 'S';
      fields[f].unit = field.type.unit;
    }
    std::vector<char> record(header.type.width);
    for (std::size_t i = 0; i < count && !record.empty(); ++i) {
      ReadAll(record, "its records");
      std::size_t at = 0;
      for (std::size_t f = 0; f < fields.size(); ++f) {
        const NpyField& field = header.fields[f];
        for (std::size_t k = 0; k < field.count; ++k, at += field.type.width) {
          if (field.type.kind != 'V') AddElement(&record[at], field.type, fields[f]);
        }
      }
    }
    for (std::size_t f = 0; f < fields.size(); ++f) {
      if (!header.fields[f].name.empty()) array.fields.push_back(std::move(fields[f]));
    }
  }

  static void AddElement(const char* from, const NpyType& type, NpyArray& array) {
    if (array.is_text) {
      array.texts.push_back(type.width == 0 ? std::string() : Text(from, type));
    } else {
      array.numbers.push_back(Number(from, type));
    }
  }

  /// Reads the elements in pieces, so that memory grows with the data and not with what the header
  /// claims.
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
        AddElement(&bytes[i * type.width], type, array);
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
