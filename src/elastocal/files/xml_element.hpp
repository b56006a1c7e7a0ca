// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <pugixml.hpp>

namespace elastocal {

class XmlElement;

/// A parsed XML text whose elements know their places in the text.
class XmlText {
 public:
  /// Text and source must outlive the object. Throws InputError naming file and line: malformed
  /// XML, no element or several at the top, a NUL byte, more than 16 MiB. Only UTF-8 is read,
  /// whatever the text declares.
  XmlText(const std::string& text, const std::string& source);
  XmlText(const XmlText&) = delete;
  XmlText& operator=(const XmlText&) = delete;

  XmlElement Root() const;

 private:
  friend class XmlElement;

  [[noreturn]] void Fail(std::size_t place, const std::string& message) const;
  /// Place in the text of a name or value that the parser returned.
  std::size_t Offset(const char* parsed) const { return parsed - buffer_.data(); }

  const std::string& text_;
  const std::string& source_;
  std::string buffer_;  ///< parsed in place: names and values of the tree point into it
  pugi::xml_document tree_;
};

/// An element with checked access to its attributes and children. All methods throw InputError
/// naming file and line if the file does not hold what is asked for.
class XmlElement {
 public:
  /// The text must outlive the element.
  XmlElement(const XmlText& text, pugi::xml_node node) : text_(&text), node_(node) {}

  [[noreturn]] void Fail(const std::string& message) const;

  std::string_view Tag() const { return node_.name(); }
  std::vector<XmlElement> Children() const;
  /// The child element with this name. A second one is an error, because programs do not agree on
  /// which of two counts.
  std::optional<XmlElement> Find(const char* child) const;
  /// The first child element with this name; others may follow.
  std::optional<XmlElement> FindFirst(const char* child) const;
  XmlElement Get(const char* child) const;

  std::size_t AttributeCount() const;
  bool Has(const char* attribute) const { return !node_.attribute(attribute).empty(); }
  /// Text of an attribute; it must be UTF-8, not empty and without control characters.
  std::string Text(const char* attribute) const;
  /// A number, or three numbers with spaces between them (Vector). They must be finite and within
  /// the bounds that bounds.hpp has for the element's attribute.
  double Number(const char* attribute) const;
  double NumberOr(const char* attribute, double otherwise) const;
  Eigen::Vector3d Vector(const char* attribute) const;

  /// A piece of the text.
  struct Range {
    std::size_t begin, length;
  };
  /// The value of an attribute that is there, without its quotes.
  Range ValueRange(const char* attribute) const;
  /// Place after the name in the start tag (NameEnd), and after the start tag (StartTagEnd).
  std::size_t NameEnd() const;
  std::size_t StartTagEnd() const;
  /// Place of the element's first character (Begin), and after its end tag (End).
  std::size_t Begin() const { return NameEnd() - Tag().size() - 1; }
  std::size_t End() const;

 private:
  pugi::xml_attribute Attribute(const char* attribute) const;
  Range RangeOf(const pugi::xml_attribute& attribute) const;
  std::string Label() const;
  void CheckBounds(const char* attribute, double value) const;  ///< see bounds.hpp
  [[noreturn]] void FailAttribute(const char* attribute, const std::string& expected) const;

  const XmlText* text_;
  pugi::xml_node node_;
};

}  // namespace elastocal
