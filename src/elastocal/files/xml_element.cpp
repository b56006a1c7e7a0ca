// SPDX-License-Identifier: Apache-2.0
#include "elastocal/files/xml_element.hpp"

#include <algorithm>
#include <iterator>

#include "elastocal/files/bounds.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/utf8.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {

XmlText::XmlText(const std::string& text, const std::string& source)
    : text_(text), source_(source), buffer_(text) {
  constexpr std::size_t kLargestText = 16u << 20;
  if (text.size() > kLargestText) {
    throw InputError(source + ": has more than 16 MiB; a URDF was expected");
  }
  if (const std::size_t nul = text.find('\0'); nul != std::string::npos) {
    Fail(nul, "found a NUL byte; a URDF (XML text in UTF-8) was expected");
  }
  const pugi::xml_parse_result result = tree_.load_buffer_inplace(
      buffer_.data(), buffer_.size(), pugi::parse_escapes, pugi::encoding_utf8);
  if (!result) {
    const bool no_element = result.status == pugi::status_no_document_element;
    const auto place = no_element ? 0 : std::min<std::size_t>(result.offset, text.size());
    std::string_view rest = Trim(std::string_view(text).substr(place));
    rest = rest.substr(0, rest.find_first_of("\r\n"));
    Fail(place, std::string("malformed XML: ") + result.description() + " at " +
                    (rest.empty() ? "the end of the text" : Quote(rest)));
  }
  const pugi::xml_node second = tree_.document_element().next_sibling();
  if (second) Fail(Offset(second.name()), "a second element at the top: " + Quote(second.name()));
}

void XmlText::Fail(std::size_t place, const std::string& message) const {
  const auto line = 1 + std::count(text_.begin(), text_.begin() + place, '\n');
  throw InputError(Place(source_, static_cast<int>(line)) + message);
}

XmlElement XmlText::Root() const { return {*this, tree_.document_element()}; }

void XmlElement::Fail(const std::string& message) const {
  text_->Fail(text_->Offset(node_.name()), message);
}

std::string XmlElement::Label() const {
  // The inner elements have no name: the nearest one around them tells which is meant.
  const std::string tag = "<" + std::string(Tag()) + ">";
  for (pugi::xml_node node = node_; node; node = node.parent()) {
    if (!node.attribute("name")) continue;
    const std::string named =
        std::string(node.name()) + " " + Quote(node.attribute("name").value());
    return node == node_ ? named : tag + " of " + named;
  }
  return tag;
}

std::vector<XmlElement> XmlElement::Children() const {
  std::vector<XmlElement> children;
  for (const pugi::xml_node child : node_.children()) {
    if (child.type() == pugi::node_element) children.emplace_back(*text_, child);
  }
  return children;
}

std::optional<XmlElement> XmlElement::Find(const char* child) const {
  const pugi::xml_node first = node_.child(child);
  if (!first) return std::nullopt;
  if (const pugi::xml_node second = first.next_sibling(child)) {
    XmlElement(*text_, second)
        .Fail("second <" + std::string(child) + "> in " + Label() + "; one was expected");
  }
  return XmlElement(*text_, first);
}

std::optional<XmlElement> XmlElement::FindFirst(const char* child) const {
  const pugi::xml_node first = node_.child(child);
  return first ? std::optional(XmlElement(*text_, first)) : std::nullopt;
}

XmlElement XmlElement::Get(const char* child) const {
  const std::optional<XmlElement> found = Find(child);
  if (!found) Fail(Label() + " has no <" + child + ">");
  return *found;
}

std::size_t XmlElement::AttributeCount() const {
  const auto attributes = node_.attributes();
  return static_cast<std::size_t>(std::distance(attributes.begin(), attributes.end()));
}

pugi::xml_attribute XmlElement::Attribute(const char* attribute) const {
  const pugi::xml_attribute first = node_.attribute(attribute);
  if (!first) Fail(Label() + " has no attribute '" + attribute + "'");
  for (pugi::xml_attribute next = first.next_attribute(); next; next = next.next_attribute()) {
    if (std::string_view(next.name()) == attribute) {
      Fail("second attribute '" + std::string(attribute) + "' in " + Label());
    }
  }
  return first;
}

void XmlElement::FailAttribute(const char* attribute, const std::string& expected) const {
  Fail(std::string("attribute '") + attribute + "' of " + Label() + " is " +
       Quote(node_.attribute(attribute).value()) + "; " + expected);
}

std::string XmlElement::Text(const char* attribute) const {
  const std::string text = Attribute(attribute).value();
  const auto is_control = [](unsigned char character) { return character < 0x20; };
  if (text.empty() || std::any_of(text.begin(), text.end(), is_control)) {
    FailAttribute(attribute, "printable text was expected");
  }
  if (!IsUtf8(text)) FailAttribute(attribute, "text in UTF-8 was expected");
  return text;
}

double XmlElement::Number(const char* attribute) const {
  const std::optional<double> value = ParseNumber(Attribute(attribute).value());
  if (!value) FailAttribute(attribute, "a finite number was expected");
  CheckBounds(attribute, *value);
  return *value;
}

void XmlElement::CheckBounds(const char* attribute, double value) const {
  const Bound* bound = FindBound("URDF " + std::string(Tag()) + "." + attribute);
  if (bound == nullptr || bound->range().Contains(value)) return;
  FailAttribute(attribute, bound->range().InWords() + " was expected (" + bound->why + ")");
}

double XmlElement::NumberOr(const char* attribute, double otherwise) const {
  return Has(attribute) ? Number(attribute) : otherwise;
}

Eigen::Vector3d XmlElement::Vector(const char* attribute) const {
  Eigen::Vector3d vector;
  std::string_view rest = Trim(Attribute(attribute).value());
  for (double& component : vector) {
    const std::string_view word = rest.substr(0, rest.find_first_of(" \t\r\n"));
    const std::optional<double> value = ParseNumber(word);
    rest = Trim(rest.substr(word.size()));
    if (!value || (&component == &vector.z() && !rest.empty())) {
      FailAttribute(attribute, "three finite numbers were expected");
    }
    CheckBounds(attribute, *value);
    component = *value;
  }
  return vector;
}

XmlElement::Range XmlElement::RangeOf(const pugi::xml_attribute& attribute) const {
  const std::size_t begin = text_->Offset(attribute.value());
  // Entities were resolved in the buffer, but not in the text, which has a quote at both ends.
  return {begin, text_->text_.find(text_->text_[begin - 1], begin) - begin};
}

XmlElement::Range XmlElement::ValueRange(const char* attribute) const {
  return RangeOf(Attribute(attribute));
}

std::size_t XmlElement::NameEnd() const { return text_->Offset(node_.name()) + Tag().size(); }

std::size_t XmlElement::StartTagEnd() const {
  std::size_t place = NameEnd();
  if (const pugi::xml_attribute last = node_.last_attribute()) {
    const Range value = RangeOf(last);
    place = value.begin + value.length;
  }
  return text_->text_.find('>', place) + 1;
}

std::size_t XmlElement::End() const {
  const std::string& text = text_->text_;
  std::size_t place = StartTagEnd();
  // The parser has found the text well-formed: end tags match, and comments end.
  for (int depth = text[place - 2] == '/' ? 0 : 1; depth > 0;) {
    place = text.find('<', place);
    const std::string_view rest = std::string_view(text).substr(place);
    if (rest.starts_with("<!--")) {
      place = text.find("-->", place + 4) + 3;
    } else if (rest.starts_with("<![CDATA[")) {
      place = text.find("]]>", place) + 3;
    } else if (rest.starts_with("<?")) {
      place = text.find("?>", place) + 2;
    } else {
      const bool closes = rest.starts_with("</");
      for (; text[place] != '>'; ++place) {
        if (text[place] == '"' || text[place] == '\'') place = text.find(text[place], place + 1);
      }
      depth += closes ? -1 : text[place - 1] == '/' ? 0 : 1;
      ++place;
    }
  }
  return place;
}

}  // namespace elastocal
