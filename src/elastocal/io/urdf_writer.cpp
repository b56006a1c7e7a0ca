#include "elastocal/io/urdf_writer.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "elastocal/io/urdf_outline.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

struct Edit {
  std::size_t begin, length;
  std::string text;
};

std::string Write(const Eigen::Vector3d& vector) {
  return FormatNumber(vector.x()) + " " + FormatNumber(vector.y()) + " " + FormatNumber(vector.z());
}

void EditAttribute(const XmlElement& origin, const char* name, const Eigen::Vector3d& value,
                   std::vector<Edit>& edits) {
  if (origin.Has(name)) {
    const auto [begin, length] = origin.ValueRange(name);
    edits.push_back({begin, length, Write(value)});
  } else {
    edits.push_back({origin.NameEnd(), 0, std::string(" ") + name + "=\"" + Write(value) + "\""});
  }
}

/// A new origin as the first thing in the joint, on a line of its own where the next tag is.
Edit InsertOrigin(const std::string& urdf, const XmlElement& joint, const UrdfOrigin& origin) {
  const std::size_t begin = joint.StartTagEnd();
  const std::size_t next = std::min(urdf.find_first_not_of(" \t\r\n", begin), urdf.size());
  std::string space = urdf.substr(begin, next - begin);
  const std::size_t last_line = space.rfind('\n');
  if (last_line != std::string::npos) {
    const bool carriage_return = last_line > 0 && space[last_line - 1] == '\r';
    space.erase(0, carriage_return ? last_line - 1 : last_line);
  }
  return {begin, 0,
          space + "<origin xyz=\"" + Write(origin.xyz) + "\" rpy=\"" + Write(origin.rpy) + "\"/>"};
}

void EditOrigin(const std::string& urdf, const UrdfJoint& joint, const UrdfOrigin& wanted,
                std::vector<Edit>& edits) {
  const bool same_xyz = joint.origin.xyz == wanted.xyz, same_rpy = joint.origin.rpy == wanted.rpy;
  if (same_xyz && same_rpy) return;
  const auto origin = joint.element.Find("origin");
  if (!origin) {
    edits.push_back(InsertOrigin(urdf, joint.element, wanted));
    return;
  }
  if (!same_xyz) EditAttribute(*origin, "xyz", wanted.xyz, edits);
  if (!same_rpy) EditAttribute(*origin, "rpy", wanted.rpy, edits);
}

std::string Apply(const std::string& text, std::vector<Edit> edits) {
  std::stable_sort(edits.begin(), edits.end(),
                   [](const Edit& a, const Edit& b) { return a.begin < b.begin; });
  std::string result;
  std::size_t done = 0;
  for (const Edit& edit : edits) {
    result.append(text, done, edit.begin - done);
    result += edit.text;
    done = edit.begin + edit.length;
  }
  return result.append(text, done);
}

}  // namespace

std::map<std::string, UrdfOrigin> ReadOrigins(const std::string& urdf, const std::string& source) {
  const XmlText xml(urdf, source);
  std::map<std::string, UrdfOrigin> origins;
  for (const UrdfJoint& joint : ReadUrdfOutline(xml).joints) origins[joint.name] = joint.origin;
  return origins;
}

std::string ReplaceOrigins(const std::string& urdf, const std::string& source,
                           const std::map<std::string, UrdfOrigin>& origins) {
  const XmlText xml(urdf, source);
  const UrdfOutline outline = ReadUrdfOutline(xml);
  std::vector<std::string> names;
  for (const UrdfJoint& joint : outline.joints) names.push_back(joint.name);
  std::vector<Edit> edits;
  for (const auto& [name, origin] : origins) {
    const auto found = outline.joint_index.find(name);
    if (found == outline.joint_index.end()) {
      throw InputError(source + ": there is no joint " + Quote(name) + DidYouMean(name, names));
    }
    if (!origin.xyz.allFinite() || !origin.rpy.allFinite()) {
      throw std::invalid_argument("the origin of joint '" + name + "' is not finite");
    }
    EditOrigin(urdf, outline.joints[found->second], origin, edits);
  }
  return Apply(urdf, std::move(edits));
}

}  // namespace elastocal
