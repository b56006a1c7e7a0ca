// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "elastocal/calibration/placement.hpp"

namespace YAML {  // NOLINT(readability-identifier-naming)
class Emitter;
}

namespace elastocal {

class YamlValue;

/// The attitude in which the root link was held while trials were recorded.
struct HeldRoot {
  /// The direction up in the calibrated root link's frame: the mean over all postures of trials
  /// whose root link was held, of unit length.
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  double differs = 0.0;  ///< largest angle between `up` and that of a posture, rad
};

/// The attitude of the held root link by the poses of the waist; `gravity` is in the frame of these
/// poses. Nothing where no root link was held (a posture table among them), or where it was held in
/// attitudes so different that they have no mean (more than 90 degrees from it).
std::optional<HeldRoot> FindHeldRoot(const Placement& placement, const Eigen::Vector3d& gravity);

/// Writes the key `held_root` of calibration.yaml.
void EmitHeldRoot(const HeldRoot& held, YAML::Emitter& yaml);

/// The key `held_root` of calibration.yaml; nothing where the file has none.
std::optional<HeldRoot> ReadHeldRoot(const YamlValue& root);

}  // namespace elastocal
