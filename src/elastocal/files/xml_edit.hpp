// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/files/xml_element.hpp"

namespace elastocal {

/// A piece of an XML text that is replaced by another.
struct XmlEdit {
  std::size_t begin, length;
  std::string text;
};

/// A text with the escapes that it needs in the value of an attribute.
std::string EscapedXml(const std::string& text);

/// Sets an attribute to a value; adds the attribute if the element does not have it.
XmlEdit SetAttribute(const XmlElement& element, const char* name, const std::string& value);

/// Inserts an element as the first child of `into`; on a line of its own if the next tag is on one.
XmlEdit InsertElement(const std::string& text, const XmlElement& into, const std::string& element);

/// The text with these edits, which must not overlap. Every other byte stays as it is.
std::string ApplyEdits(const std::string& text, std::vector<XmlEdit> edits);

/// Three numbers of 17 significant digits with spaces between them.
std::string WriteVector(const Eigen::Vector3d& vector);

}  // namespace elastocal
