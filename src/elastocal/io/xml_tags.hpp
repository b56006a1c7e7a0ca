#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace elastocal {

/// An attribute of a tag, as it stands in the text (entities are not resolved).
struct XmlAttribute {
  std::string_view name, value;
  std::size_t value_begin = 0;  ///< place of the value's first byte, after the quote
};

/// A start tag, end tag or empty-element tag and its place in the text.
struct XmlTag {
  std::size_t begin = 0, name_end = 0, end = 0;  ///< of '<', after the name, after '>'
  std::string_view name;
  bool closing = false;  ///< </name>
  bool empty = false;    ///< <name/>
  std::vector<XmlAttribute> attributes;
};

/// The first tag at or after `from`; comments, CDATA sections, declarations and processing
/// instructions are passed over. Nothing at the end of the text or where it is malformed. The text
/// must have passed a real XML parser: this one only says where things are.
std::optional<XmlTag> NextTag(std::string_view text, std::size_t from);

}  // namespace elastocal
