// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/identifiability/base_parameters.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/simulation/standing_recording.hpp"

namespace elastocal {

/// The embedded humanoid in the trials of a whole calibration: head, trunk and arms on both feet,
/// and each leg while the robot stands on the other one.
struct StandingHumanoid {
  Project project;
  ErrorModel model;  ///< torsion of the trunk and the arms, both legs elastic
  BaseParameters base;
  std::vector<PlayedTrial> trials;

  /// The robot with `postures` postures in each trial: head and trunk, both arms, both legs.
  explicit StandingHumanoid(int postures, std::uint64_t seed = 1, bool torque_bias = false);

  /// Draws errors of usual size for all identifiable parameters. Compliances are as the paper
  /// found.
  Eigen::VectorXd DrawTruth(std::uint64_t seed) const;

  /// Simulates what cameras and robot record. Each trial shows the waist, the chain that it moves
  /// and the foot that stands.
  Recording Record(const Eigen::VectorXd& truth, const StandingOptions& options) const;
};

}  // namespace elastocal
