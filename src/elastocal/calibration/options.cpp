// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/options.hpp"

#include <algorithm>
#include <cmath>

namespace elastocal {
namespace {

constexpr double kExternalScale = 0.01;  // m and rad
constexpr double kUnknown = 1e3;         // times the unit of a parameter: beyond, nothing is known

/// Typical error of a parameter of a new robot, SI.
double TypicalError(ParameterKind kind) {
  switch (kind) {
    case ParameterKind::kTorsion:
    case ParameterKind::kBending:
    case ParameterKind::kLegMoment:
      return 5e-5;
    case ParameterKind::kLegForce:
      return 1e-5;
    case ParameterKind::kTorqueBias:
      return 2.0;
    default:
      return IsAngle(kind) ? 0.5 * M_PI / 180.0 : 1e-3;
  }
}

constexpr double kSlideCompliance = 1e-6;  // m/N, of a slide without effort

}  // namespace

const char* PriorGroupName(PriorGroup group) {
  static constexpr const char* kNames[] = {"angles",      "lengths",    "torsion",
                                           "bending",     "base_force", "base_moment",
                                           "torque_bias", "corrections"};
  return kNames[static_cast<int>(group)];
}

PriorGroup GroupOf(ParameterKind kind) {
  switch (kind) {
    case ParameterKind::kTorsion:
      return PriorGroup::kTorsion;
    case ParameterKind::kBending:
      return PriorGroup::kBending;
    case ParameterKind::kLegForce:
      return PriorGroup::kLegForce;
    case ParameterKind::kLegMoment:
      return PriorGroup::kLegMoment;
    case ParameterKind::kTorqueBias:
      return PriorGroup::kTorqueBias;
    case ParameterKind::kCorrection:
      return PriorGroup::kCorrections;
    default:
      return IsAngle(kind) ? PriorGroup::kAngles : PriorGroup::kLengths;
  }
}

double MostWidening(PriorGroup group) {
  const bool elastic = group != PriorGroup::kAngles && group != PriorGroup::kLengths &&
                       group != PriorGroup::kCorrections;
  return elastic ? 100.0 : 10.0;
}

Prior::Prior() {
  sd.fill(1.0);
  for (int i = 0; i < kParameterKindCount; ++i) {
    const auto kind = static_cast<ParameterKind>(i);
    if (!IsExternal(kind)) sd[i] = TypicalError(kind);
  }
  (*this)[ParameterKind::kTorsion] = (*this)[ParameterKind::kBending] = 0.0;
}

double Prior::Of(const RobotTree& tree, const Parameter& parameter) const {
  // Corrections and linkages bring their own.
  double own = parameter.typical > 0.0 ? parameter.typical : (*this)[parameter.kind];
  if (own == 0.0) {
    const Joint& joint = tree.joints[parameter.joint];
    const bool slides = joint.type == JointType::kPrismatic;
    const double effort = joint.limits.effort;
    const bool known = std::isfinite(effort) && effort > 0.0;
    own = known    ? (slides ? slide_deflection : deflection) / effort
          : slides ? kSlideCompliance
                   : TypicalError(parameter.kind);
  }
  if (!IsExternal(parameter.kind)) own *= scale[GroupOf(parameter.kind)];
  return std::min(own, kUnknown * ParameterScale(parameter));
}

double ParameterScale(const Parameter& parameter) {
  if (parameter.kind == ParameterKind::kCorrection) return parameter.typical;
  return IsExternal(parameter.kind) ? kExternalScale : TypicalError(parameter.kind);
}

std::string GaugeText(const Gauge& gauge) {
  switch (gauge.rule) {
    case GaugeRule::kPrior:
      return "prior";
    case GaugeRule::kNominalMarkers:
      return "nominal_markers";
    default:
      return "link " + gauge.link;
  }
}

}  // namespace elastocal
