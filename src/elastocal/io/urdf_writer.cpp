#include "elastocal/io/urdf_writer.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <vector>

#include "elastocal/io/text.hpp"
#include "elastocal/io/urdf_document.hpp"
#include "elastocal/io/xml_tags.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

/// Where a joint of the robot stands in the text.
struct JointPlace {
  XmlTag joint;
  std::optional<XmlTag> origin;
};

/// Joints and origins that are what a URDF means by them: <robot><joint><origin>. Transmissions
/// and simulator plugins hold others of the same name further down.
std::vector<JointPlace> FindJointPlaces(const std::string& urdf) {
  std::vector<JointPlace> places;
  int depth = 0;
  bool in_joint = false;
  for (auto tag = NextTag(urdf, 0); tag; tag = NextTag(urdf, tag->end)) {
    if (tag->closing) {
      if (--depth == 0) break;  // of <robot>
      continue;
    }
    if (depth == 1) {
      in_joint = tag->name == "joint";
      if (in_joint) places.push_back({*tag, std::nullopt});
    }
    if (depth == 2 && in_joint && tag->name == "origin") places.back().origin = *tag;
    if (!tag->empty) ++depth;
  }
  return places;
}

struct Edit {
  std::size_t begin, length;
  std::string text;
};

std::string Write(const Eigen::Vector3d& vector) {
  return FormatNumber(vector.x()) + " " + FormatNumber(vector.y()) + " " + FormatNumber(vector.z());
}

void EditAttribute(const XmlTag& tag, const char* name, const Eigen::Vector3d& value,
                   std::vector<Edit>& edits) {
  for (const XmlAttribute& attribute : tag.attributes) {
    if (attribute.name != name) continue;
    edits.push_back({attribute.value_begin, attribute.value.size(), Write(value)});
    return;
  }
  edits.push_back({tag.name_end, 0, std::string(" ") + name + "=\"" + Write(value) + "\""});
}

/// A new origin as the first thing in the joint, on a line of its own where the next tag is.
Edit InsertOrigin(const std::string& urdf, const JointPlace& place, const UrdfOrigin& origin) {
  const std::size_t begin = place.joint.end;
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

void EditOrigin(const std::string& urdf, const JointPlace& place, const UrdfOrigin& old,
                const UrdfOrigin& wanted, std::vector<Edit>& edits) {
  const bool same_xyz = old.xyz == wanted.xyz, same_rpy = old.rpy == wanted.rpy;
  if (!place.origin) {
    if (!same_xyz || !same_rpy) edits.push_back(InsertOrigin(urdf, place, wanted));
    return;
  }
  if (!same_xyz) EditAttribute(*place.origin, "xyz", wanted.xyz, edits);
  if (!same_rpy) EditAttribute(*place.origin, "rpy", wanted.rpy, edits);
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

void CheckRequest(const std::string& source, const std::map<std::string, UrdfOrigin>& known,
                  const std::map<std::string, UrdfOrigin>& wanted) {
  std::vector<std::string> names;
  for (const auto& [name, origin] : known) names.push_back(name);
  for (const auto& [name, origin] : wanted) {
    if (!known.contains(name)) {
      throw InputError(source + ": there is no joint " + Quote(name) + DidYouMean(name, names));
    }
    if (!origin.xyz.allFinite() || !origin.rpy.allFinite()) {
      throw std::invalid_argument("the origin of joint '" + name + "' is not finite");
    }
  }
}

}  // namespace

std::map<std::string, UrdfOrigin> ReadOrigins(const std::string& urdf, const std::string& source) {
  std::map<std::string, UrdfOrigin> origins;
  for (const UrdfJoint& joint : CheckUrdf(urdf, source).joints) {
    origins[joint.name] = joint.origin;
  }
  return origins;
}

std::string ReplaceOrigins(const std::string& urdf, const std::string& source,
                           const std::map<std::string, UrdfOrigin>& origins) {
  const std::vector<UrdfJoint> joints = CheckUrdf(urdf, source).joints;
  std::map<std::string, UrdfOrigin> expected;
  for (const UrdfJoint& joint : joints) expected[joint.name] = joint.origin;
  CheckRequest(source, expected, origins);

  const std::vector<JointPlace> places = FindJointPlaces(urdf);
  std::vector<Edit> edits;
  for (std::size_t i = 0; i < std::min(places.size(), joints.size()); ++i) {
    const auto wanted = origins.find(joints[i].name);
    if (wanted == origins.end()) continue;
    EditOrigin(urdf, places[i], joints[i].origin, wanted->second, edits);
    expected[joints[i].name] = wanted->second;
  }
  std::string result = Apply(urdf, std::move(edits));
  // The tag scanner is ours: what it did is confirmed by the real parser.
  const std::map<std::string, UrdfOrigin> written = ReadOrigins(result, source);
  for (const auto& [name, origin] : expected) {
    const auto found = written.find(name);
    if (places.size() != joints.size() || found == written.end() ||
        found->second.xyz != origin.xyz || found->second.rpy != origin.rpy) {
      throw InputError(source + ": cannot put a new origin into joint " + Quote(name) +
                       "; write the URDF in plain XML");
    }
  }
  return result;
}

}  // namespace elastocal
