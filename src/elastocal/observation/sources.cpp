// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/sources.hpp"

#include <cmath>

#include "elastocal/calibration/options.hpp"

namespace elastocal {

std::vector<Source> CommonSources() {
  constexpr double kDegreeOfArc = M_PI / 180.0;
  const Prior prior;
  std::vector<Source> sources(kCommonSources);
  const auto set = [&](CommonSource which, const char* name, SourceUnit unit, double sd,
                       Source::Role role = Source::Role::kPrior) {
    sources[which] = {name, unit, sd, role};
  };
  const SourceUnit metre = SourceUnit::kMetre;
  const SourceUnit radian = SourceUnit::kRadian;
  set(kHeight, "height", metre, 3e-3, Source::Role::kNoise);
  set(kTilt, "tilt", radian, 0.3 * kDegreeOfArc, Source::Role::kNoise);
  set(kSessionHeight, "session_height", metre, 1e-3);
  set(kSessionTilt, "session_tilt", radian, 0.2 * kDegreeOfArc);
  set(kTrackerPlace, "session_place", metre, 5e-3);
  set(kTrackerTurn, "session_turn", radian, 0.5 * kDegreeOfArc);
  set(kTableTilt, "table_tilt", radian, kDegreeOfArc);
  set(kPlateTilt, "plate_tilt", radian, 0.5 * kDegreeOfArc);
  set(kLegOffset, "leg_offset", radian, prior[ParameterKind::kTheta]);
  set(kTrunkOffset, "trunk_offset", radian, prior[ParameterKind::kTheta]);
  set(kLimbOffset, "limb_offset", radian, prior[ParameterKind::kTheta]);
  set(kLength, "length", metre, prior[ParameterKind::kD]);
  set(kAngle, "angle", radian, prior[ParameterKind::kAlpha]);
  set(kTorsion, "torsion", SourceUnit::kNone, 1.0);
  set(kBending, "bending", SourceUnit::kNone, 1.0);
  set(kCause, "causes", SourceUnit::kNone, 1.0);
  set(kUnknownPlace, "unknown_place", metre, 1.0, Source::Role::kFixed);
  set(kUnknownTurn, "unknown_turn", radian, 1.0, Source::Role::kFixed);
  set(kRootTilt, "root_tilt", radian, kDegreeOfArc, Source::Role::kFixed);
  return sources;
}

Spread FirstSpread(const std::vector<Source>& sources) {
  Spread spread;
  for (const Source& source : sources) spread.sd.push_back(source.sd);
  return spread;
}

}  // namespace elastocal
