#include "elastocal/contact/contact_spread.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/calibration/options.hpp"

namespace elastocal {
namespace {

constexpr double kDegreeOfArc = M_PI / 180.0;

/// How many feet and plates a joint carries.
struct CarriedContacts {
  int feet = 0, plates = 0;
};

std::vector<CarriedContacts> CountCarried(const ContactModel& model) {
  const RobotTree& tree = model.robot.tree;
  std::vector<CarriedContacts> carried(tree.joints.size());
  for (const ContactFoot& foot : model.setup.feet) {
    for (int k : JointsToBody(tree, tree.links[foot.link].body)) ++carried[k].feet;
  }
  for (const ContactPlate& plate : model.setup.plates) {
    for (int k : JointsToBody(tree, tree.links[plate.link].body)) ++carried[k].plates;
  }
  return carried;
}

}  // namespace

const char* ContactSourceName(ContactSource source) {
  static constexpr const char* kNames[] = {
      "height",     "tilt",       "session_height", "session_tilt", "table_tilt",
      "plate_tilt", "leg_offset", "trunk_offset",   "limb_offset",  "length",
      "angle",      "torsion",    "bending"};
  static_assert(std::size(kNames) == kContactSourceCount);
  return kNames[static_cast<int>(source)];
}

bool IsAngular(ContactSource source) {
  switch (source) {
    case ContactSource::kHeight:
    case ContactSource::kSessionHeight:
    case ContactSource::kLength:
    case ContactSource::kTorsion:
    case ContactSource::kBending:
      return false;
    default:
      return true;
  }
}

ContactSpread::ContactSpread() {
  using Source = ContactSource;
  sd.fill(1.0);
  (*this)[Source::kHeight] = 3e-3;
  (*this)[Source::kTilt] = 0.3 * kDegreeOfArc;
  (*this)[Source::kSessionHeight] = 1e-3;
  (*this)[Source::kSessionTilt] = 0.2 * kDegreeOfArc;
  (*this)[Source::kTableTilt] = kDegreeOfArc;
  (*this)[Source::kPlateTilt] = 0.5 * kDegreeOfArc;
  for (Source offset : {Source::kLegOffset, Source::kTrunkOffset, Source::kLimbOffset}) {
    (*this)[offset] = Prior()[ParameterKind::kTheta];
  }
  (*this)[Source::kLength] = Prior()[ParameterKind::kD];
  (*this)[Source::kAngle] = Prior()[ParameterKind::kAlpha];
}

std::vector<SourceOfParameter> SourcesOfParameters(const ContactModel& model) {
  const std::vector<CarriedContacts> carried = CountCarried(model);
  const Prior prior;
  std::vector<SourceOfParameter> sources;
  for (const Parameter& parameter : model.robot.parameters) {
    SourceOfParameter of;
    if (IsCompliance(parameter.kind)) {
      of.source = parameter.kind == ParameterKind::kTorsion ? ContactSource::kTorsion
                                                            : ContactSource::kBending;
      of.unit = prior.Of(model.robot.tree, parameter);
    } else if (parameter.kind == ParameterKind::kTheta && parameter.joint >= 0) {
      const CarriedContacts& by = carried[parameter.joint];
      of.source = by.feet > 0     ? ContactSource::kLegOffset
                  : by.plates > 1 ? ContactSource::kTrunkOffset
                                  : ContactSource::kLimbOffset;
    } else if (IsAngle(parameter.kind)) {
      of.source = ContactSource::kAngle;
    }
    sources.push_back(of);
  }
  return sources;
}

}  // namespace elastocal
