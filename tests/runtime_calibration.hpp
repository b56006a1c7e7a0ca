// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "elastocal/io/calibration_file.hpp"
#include "elastocal/io/fingerprint.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// A calibration with errors of usual sizes for all joints and legs of a project's robot, as if it
/// had been read from a file.
inline StoredCalibration RandomCalibration(const Project& project, std::uint64_t seed) {
  Elasticity elasticity;
  for (std::size_t k = 0; k < project.tree.joints.size(); ++k) {
    elasticity.torsion.push_back(static_cast<int>(k));
    if (project.tree.joints[k].type == JointType::kRevolute) {
      elasticity.bending.push_back(static_cast<int>(k));
      if (project.tree.joints[k].parent_body == 0) {
        elasticity.root_bending.push_back(static_cast<int>(k));
      }
    }
  }
  for (const Chain& chain : project.chains) {
    if (chain.name.starts_with("leg")) elasticity.legs.push_back({chain.name, chain.tip_link});
  }
  const ErrorModel model =
      MakeErrorModel(project.tree, project.markers, project.placement, elasticity);
  Random random(seed);
  StoredCalibration stored;
  stored.source = "random";
  stored.robot = project.tree.name;
  stored.nominal = NominalFingerprint(model);
  for (const Parameter& parameter : model.parameters) {
    if (IsExternal(parameter.kind)) continue;
    double size = IsAngle(parameter.kind) ? 0.01 : 1e-3;
    if (IsCompliance(parameter.kind)) size = 2e-5;
    if (parameter.kind == ParameterKind::kLegForce) size = 1e-6;
    const double value = random.Normal(size);
    stored.joint_errors[parameter.name] = IsCompliance(parameter.kind) ? std::abs(value) : value;
  }
  return stored;
}

}  // namespace elastocal
