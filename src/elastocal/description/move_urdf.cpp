// SPDX-License-Identifier: Apache-2.0
#include "elastocal/description/move_urdf.hpp"

#include <vector>

#include "elastocal/files/xml_edit.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

/// Whether a file is found from the folder of the URDF.
bool IsFoundFromUrdf(const std::string& name) {
  return !name.empty() && name.find(':') == std::string::npos &&
         name.find('$') == std::string::npos && fs::path(name).is_relative();
}

void LeadBack(const XmlElement& within, const fs::path& back, std::vector<XmlEdit>& edits) {
  for (const XmlElement& child : within.Children()) {
    LeadBack(child, back, edits);
    if ((child.Tag() != "mesh" && child.Tag() != "texture") || !child.Has("filename")) continue;
    const std::string name(child.Text("filename"));
    if (!IsFoundFromUrdf(name)) continue;
    const std::string moved = (back / name).lexically_normal().generic_string();
    edits.push_back(SetAttribute(child, "filename", EscapedXml(moved)));
  }
}

}  // namespace

std::string MoveUrdf(const std::string& urdf, const std::string& source, const fs::path& from,
                     const fs::path& to) {
  const auto folder = [](const fs::path& path) {
    return fs::weakly_canonical(path.empty() ? fs::path(".") : path);
  };
  const fs::path back = folder(from).lexically_relative(folder(to));
  if (back.empty() || back == ".") return urdf;
  const XmlText xml(urdf, source);
  std::vector<XmlEdit> edits;
  LeadBack(xml.Root(), back, edits);
  return ApplyEdits(urdf, std::move(edits));
}

}  // namespace elastocal
