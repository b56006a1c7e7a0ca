// SPDX-License-Identifier: Apache-2.0
#include "elastocal/files/xml_edit.hpp"

#include <algorithm>

#include "elastocal/tables/text.hpp"

namespace elastocal {

std::string EscapedXml(const std::string& text) {
  std::string safe;
  for (char c : text) {
    if (c == '<' || c == '>' || c == '&' || c == '"' || c == '\'') {
      safe += "&#" + std::to_string(static_cast<int>(c)) + ";";
    } else {
      safe += c;
    }
  }
  return safe;
}

XmlEdit SetAttribute(const XmlElement& element, const char* name, const std::string& value) {
  if (element.Has(name)) {
    const auto [begin, length] = element.ValueRange(name);
    return {begin, length, value};
  }
  return {element.NameEnd(), 0, std::string(" ") + name + "=\"" + value + "\""};
}

XmlEdit InsertElement(const std::string& text, const XmlElement& into, const std::string& element) {
  const std::size_t begin = into.StartTagEnd();
  const std::size_t next = std::min(text.find_first_not_of(" \t\r\n", begin), text.size());
  std::string space = text.substr(begin, next - begin);
  const std::size_t last_line = space.rfind('\n');
  if (last_line != std::string::npos) {
    const bool carriage_return = last_line > 0 && space[last_line - 1] == '\r';
    space.erase(0, carriage_return ? last_line - 1 : last_line);
  }
  return {begin, 0, space + element};
}

std::string ApplyEdits(const std::string& text, std::vector<XmlEdit> edits) {
  std::stable_sort(edits.begin(), edits.end(),
                   [](const XmlEdit& a, const XmlEdit& b) { return a.begin < b.begin; });
  std::string result;
  std::size_t done = 0;
  for (const XmlEdit& edit : edits) {
    result.append(text, done, edit.begin - done);
    result += edit.text;
    done = edit.begin + edit.length;
  }
  return result.append(text, done);
}

std::string WriteVector(const Eigen::Vector3d& vector) {
  return FormatNumber(vector.x()) + " " + FormatNumber(vector.y()) + " " + FormatNumber(vector.z());
}

}  // namespace elastocal
