#include "elastocal/io/urdf_document.hpp"

#include <algorithm>

#include <tinyxml2.h>

#include "elastocal/io/text.hpp"
#include "elastocal/io/urdf_outline.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kLargestText = 16u << 20;
/// Below this an axis is rounding noise, not a direction.
constexpr double kShortestAxis = 1e-6;

void CheckBytes(const std::string& text, const std::string& source) {
  if (text.size() > kLargestText) {
    throw InputError(source + ": has more than 16 MiB; a URDF was expected");
  }
  const auto nul = std::find(text.begin(), text.end(), '\0');
  if (nul != text.end()) {
    const auto line = 1 + std::count(text.begin(), nul, '\n');
    throw InputError(Place(source, static_cast<int>(line)) +
                     "found a NUL byte; a URDF (XML text) was expected");
  }
}

/// tinyxml2 has names of constants for its errors, not words.
std::string InWords(tinyxml2::XMLError error) {
  switch (error) {
    case tinyxml2::XML_ERROR_PARSING_ELEMENT:
      return "a tag that cannot be read";
    case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
      return "an attribute that cannot be read; name=\"value\" was expected";
    case tinyxml2::XML_ERROR_PARSING_TEXT:
      return "text where a tag was expected";
    case tinyxml2::XML_ERROR_PARSING_CDATA:
      return "a CDATA section without end";
    case tinyxml2::XML_ERROR_PARSING_COMMENT:
      return "a comment without end";
    case tinyxml2::XML_ERROR_PARSING_DECLARATION:
      return "a declaration <?...?> without end or in the wrong place";
    case tinyxml2::XML_ERROR_PARSING_UNKNOWN:
      return "a tag <!...> without end";
    case tinyxml2::XML_ERROR_EMPTY_DOCUMENT:
      return "no tag at all";
    case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT:
      return "a tag whose end is missing or is that of another one";
    case tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED:
      return "too many elements in one another";
    default:
      return "tags that are not closed";
  }
}

void ParseXml(const std::string& text, const std::string& source, tinyxml2::XMLDocument& xml) {
  if (xml.Parse(text.data(), text.size()) == tinyxml2::XML_SUCCESS) return;
  throw InputError(Place(source, std::max(1, xml.ErrorLineNum())) +
                   "malformed XML: " + InWords(xml.ErrorID()));
}

/// Writes what urdfdom is to read, checking the numbers on the way.
class CanonicalUrdf {
 public:
  std::string Write(const UrdfOutline& outline, const UrdfDocument& document) {
    Open("robot");
    out_.PushAttribute("name", outline.robot.c_str());
    for (const std::string& name : document.links) {
      WriteLink(outline.links[outline.link_index.at(name)]);
    }
    for (const UrdfJointEntry& entry : outline.joints) {
      if (!entry.joint.dropped) WriteJoint(entry);
    }
    Close();
    return out_.CStr();
  }

 private:
  void Open(const char* element) { out_.OpenElement(element, true); }
  void Close() { out_.CloseElement(true); }

  void PushNumber(const char* attribute, double value) {
    out_.PushAttribute(attribute, FormatNumber(value).c_str());
  }

  void CopyNumber(const UrdfElement& element, const char* attribute) {
    PushNumber(attribute, element.Number(attribute));
  }

  void CopyOptionalNumber(const UrdfElement& element, const char* attribute) {
    if (element.Has(attribute)) CopyNumber(element, attribute);
  }

  void PushVector(const char* attribute, const Eigen::Vector3d& vector) {
    const std::string text =
        FormatNumber(vector.x()) + " " + FormatNumber(vector.y()) + " " + FormatNumber(vector.z());
    out_.PushAttribute(attribute, text.c_str());
  }

  void WriteOrigin(const UrdfOrigin& origin) {
    Open("origin");
    PushVector("xyz", origin.xyz);
    PushVector("rpy", origin.rpy);
    Close();
  }

  void WriteLink(const UrdfLinkEntry& link) {
    Open("link");
    out_.PushAttribute("name", link.name.c_str());
    if (const auto inertial = link.element.Find("inertial")) {
      Open("inertial");
      WriteOrigin(ReadUrdfOrigin(*inertial));
      WriteMass(inertial->Get("mass"));
      const UrdfElement inertia = inertial->Get("inertia");
      Open("inertia");
      for (const char* entry : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}) {
        CopyNumber(inertia, entry);
      }
      Close();
      Close();
    }
    Close();
  }

  void WriteMass(const UrdfElement& mass) {
    const double value = mass.Number("value");
    if (value < 0.0)
      mass.Fail("found a mass of " + FormatNumber(value) + " kg; at least 0 was expected");
    Open("mass");
    PushNumber("value", value);
    Close();
  }

  void WriteJoint(const UrdfJointEntry& entry) {
    const UrdfJoint& joint = entry.joint;
    Open("joint");
    out_.PushAttribute("name", joint.name.c_str());
    out_.PushAttribute("type", joint.type.c_str());
    WriteOrigin(joint.origin);
    WriteLinkReference("parent", joint.parent);
    WriteLinkReference("child", joint.child);
    if (joint.type != "fixed") {
      WriteAxis(entry.element);
      WriteLimit(entry);
      WriteMimic(entry);
    }
    Close();
  }

  void WriteLinkReference(const char* element, const std::string& link) {
    Open(element);
    out_.PushAttribute("link", link.c_str());
    Close();
  }

  void WriteAxis(const UrdfElement& joint) {
    const auto axis = joint.Find("axis");
    if (!axis) return;
    const Eigen::Vector3d xyz = axis->Vector("xyz");
    if (xyz.stableNorm() < kShortestAxis) axis->Fail("the axis is zero; a direction was expected");
    Open("axis");
    PushVector("xyz", xyz.stableNormalized());
    Close();
  }

  void WriteLimit(const UrdfJointEntry& entry) {
    const bool required = entry.joint.type != "continuous";
    if (!required && !entry.element.Find("limit")) return;
    const UrdfElement limit = entry.element.Get("limit");
    Open("limit");
    CopyOptionalNumber(limit, "lower");
    CopyOptionalNumber(limit, "upper");
    CopyNumber(limit, "effort");
    CopyNumber(limit, "velocity");
    Close();
    const double lower = limit.Has("lower") ? limit.Number("lower") : 0.0;
    const double upper = limit.Has("upper") ? limit.Number("upper") : 0.0;
    if (required && lower > upper) {
      limit.Fail("joint " + Quote(entry.joint.name) + ": lower limit " + FormatNumber(lower) +
                 " is above upper limit " + FormatNumber(upper));
    }
  }

  void WriteMimic(const UrdfJointEntry& entry) {
    const auto mimic = entry.element.Find("mimic");
    if (!mimic) return;
    Open("mimic");
    out_.PushAttribute("joint", entry.mimic.c_str());
    CopyOptionalNumber(*mimic, "multiplier");
    CopyOptionalNumber(*mimic, "offset");
    Close();
  }

  tinyxml2::XMLPrinter out_{nullptr, true};
};

}  // namespace

UrdfDocument CheckUrdf(const std::string& text, const std::string& source) {
  CheckBytes(text, source);
  tinyxml2::XMLDocument xml;
  ParseXml(text, source, xml);
  const tinyxml2::XMLElement* robot = xml.RootElement();
  if (robot == nullptr || std::string(robot->Name()) != "robot") {
    const int line = robot == nullptr ? 1 : robot->GetLineNum();
    throw InputError(Place(source, line) + "found " +
                     (robot == nullptr ? "no element" : "<" + std::string(robot->Name()) + ">") +
                     "; a URDF begins with <robot>");
  }
  const UrdfOutline outline = ReadUrdfOutline(*robot, source);
  UrdfDocument document;
  document.root = outline.links[outline.root].name;
  const auto below_dropped = outline.links[outline.root].parent_joint;
  for (const UrdfLinkEntry& link : outline.links) {
    const bool dropped =
        below_dropped >= 0 && link.name == outline.joints[below_dropped].joint.parent;
    if (!dropped) document.links.push_back(link.name);
  }
  for (const UrdfJointEntry& entry : outline.joints) document.joints.push_back(entry.joint);
  document.canonical = CanonicalUrdf().Write(outline, document);
  return document;
}

}  // namespace elastocal
