// SPDX-License-Identifier: Apache-2.0
#include "elastocal/description/urdf_writer.hpp"

#include <stdexcept>
#include <vector>

#include "elastocal/description/urdf_outline.hpp"
#include "elastocal/files/xml_edit.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

void EditOrigin(const std::string& urdf, const UrdfJoint& joint, const UrdfOrigin& wanted,
                std::vector<XmlEdit>& edits) {
  const bool same_xyz = joint.origin.xyz == wanted.xyz, same_rpy = joint.origin.rpy == wanted.rpy;
  if (same_xyz && same_rpy) return;
  const auto origin = joint.element.Find("origin");
  if (!origin) {
    edits.push_back(InsertElement(urdf, joint.element,
                                  "<origin xyz=\"" + WriteVector(wanted.xyz) + "\" rpy=\"" +
                                      WriteVector(wanted.rpy) + "\"/>"));
    return;
  }
  if (!same_xyz) edits.push_back(SetAttribute(*origin, "xyz", WriteVector(wanted.xyz)));
  if (!same_rpy) edits.push_back(SetAttribute(*origin, "rpy", WriteVector(wanted.rpy)));
}

const UrdfJoint& JointNamed(const UrdfOutline& outline, const std::string& source,
                            const std::string& name) {
  const auto found = outline.joint_index.find(name);
  if (found != outline.joint_index.end()) return outline.joints[found->second];
  std::vector<std::string> names;
  for (const UrdfJoint& joint : outline.joints) names.push_back(joint.name);
  throw InputError(source + ": there is no joint " + Quote(name) + DidYouMean(name, names));
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
  std::vector<XmlEdit> edits;
  for (const auto& [name, origin] : origins) {
    const UrdfJoint& joint = JointNamed(outline, source, name);
    if (!origin.xyz.allFinite() || !origin.rpy.allFinite()) {
      throw std::invalid_argument("the origin of joint '" + name + "' is not finite");
    }
    EditOrigin(urdf, joint, origin, edits);
  }
  return ApplyEdits(urdf, std::move(edits));
}

std::string ShiftReferencePositions(const std::string& urdf, const std::string& source,
                                    const std::map<std::string, double>& shifts) {
  const XmlText xml(urdf, source);
  const UrdfOutline outline = ReadUrdfOutline(xml);
  std::vector<XmlEdit> edits;
  for (const auto& [name, shift] : shifts) {
    const XmlElement joint = JointNamed(outline, source, name).element;
    const auto element = joint.Find("calibration");
    bool found = false;
    for (const char* edge : {"rising", "falling"}) {
      if (!element || !element->Has(edge)) continue;
      found = true;
      edits.push_back(SetAttribute(*element, edge, FormatNumber(element->Number(edge) + shift)));
    }
    if (found || shift == 0.0) continue;
    const std::string rising = FormatNumber(shift);
    edits.push_back(element
                        ? SetAttribute(*element, "rising", rising)
                        : InsertElement(urdf, joint, "<calibration rising=\"" + rising + "\"/>"));
  }
  return ApplyEdits(urdf, std::move(edits));
}

}  // namespace elastocal
