// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/known_truth.hpp"

#include <cmath>
#include <set>

#include "elastocal/simulation/synthetic_recording.hpp"

namespace elastocal {
namespace {

/// Markers of the upper body: on all links that no leg carries.
std::vector<std::string> UpperBodyMarkers(const Project& project) {
  std::set<std::string> legs;
  for (const Chain& chain : project.chains) {
    if (!chain.name.starts_with("leg")) continue;
    for (const std::string& name : ChainMarkers(project, chain)) legs.insert(name);
  }
  std::vector<std::string> names;
  for (const Marker& marker : project.markers) {
    if (!legs.contains(marker.name)) names.push_back(marker.name);
  }
  return names;
}

}  // namespace

KnownTruth DrawUpperBodyErrors(const Project& project, std::uint64_t seed) {
  constexpr double kDegreeInRad = M_PI / 180.0;
  KnownTruth truth;
  truth.model = SelectMarkers(MakeErrorModel(project.tree, project.markers, project.placement),
                              UpperBodyMarkers(project));
  truth.model.T_ref_waist = Transform(Eigen::Translation3d(1.2, -0.8, 1.0)) * RotZ(2.0);
  using Kind = ParameterKind;
  truth.delta =
      DrawErrors(truth.model, FindBaseParameters(truth.model, project.identifiability).kept,
                 {{Kind::kTheta, 1.0 * kDegreeInRad},
                  {Kind::kR, 1e-3},
                  {Kind::kD, 1e-3},
                  {Kind::kB, 1e-3},
                  {Kind::kAlpha, 0.3 * kDegreeInRad},
                  {Kind::kBeta, 0.3 * kDegreeInRad},
                  {Kind::kGamma, 0.3 * kDegreeInRad},
                  {Kind::kMarker, 5e-3}},
                 seed);
  return truth;
}

std::vector<FoundParameter> CompareWithTruth(const KnownTruth& truth,
                                             const CalibrationResult& result) {
  std::vector<FoundParameter> found;
  for (int i = 0; i < result.model.parameter_count(); ++i) {
    const Parameter& parameter = result.model.parameters[i];
    if (parameter.joint < 0 || result.status[i] != ParameterStatus::kEstimated) continue;
    const double true_value = truth.delta[FindParameter(truth.model.parameters, parameter.name)];
    const double error = result.delta[i] - true_value;
    found.push_back({parameter, true_value, result.delta[i], result.sd[i],
                     std::abs(error) <= result.interval_factor * result.sd[i]});
  }
  return found;
}

}  // namespace elastocal
