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

/// A text as it stands in the value of an attribute.
std::string EscapedXml(const std::string& text);

/// Gives an attribute this value; adds it where the element has none.
XmlEdit SetAttribute(const XmlElement& element, const char* name, const std::string& value);

/// Puts an element in front of what another one holds, on a line of its own where the next tag is.
XmlEdit InsertElement(const std::string& text, const XmlElement& into, const std::string& element);

/// The text with these edits, which do not overlap, and not a byte else changed.
std::string ApplyEdits(const std::string& text, std::vector<XmlEdit> edits);

/// Three numbers of 17 significant digits with spaces between them.
std::string WriteVector(const Eigen::Vector3d& vector);

}  // namespace elastocal
