// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/identifiability/base_parameters.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/simulation/standing_recording.hpp"

namespace elastocal {

/// The embedded humanoid as it is calibrated whole: head, trunk and arms on both feet, each leg
/// while the other one carries.
struct StandingHumanoid {
  Project project;
  ErrorModel model;  ///< torsion of the trunk and the arms, both legs elastic
  BaseParameters base;
  std::vector<PlayedTrial> trials;

  /// The robot with `postures` a trial: head and trunk, left and right arm, left and right leg.
  explicit StandingHumanoid(int postures, std::uint64_t seed = 1, bool torque_bias = false);

  /// Errors of usual size for all identifiable parameters; compliances as the paper found.
  Eigen::VectorXd DrawTruth(std::uint64_t seed) const;

  /// What cameras and robot record; each trial sees the waist, the chain that it moves and the foot
  /// that it stands on.
  Recording Record(const Eigen::VectorXd& truth, const StandingOptions& options) const;
};

}  // namespace elastocal
