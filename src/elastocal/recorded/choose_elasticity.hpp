// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// Whether the robot description says what its joints carry.
bool HasMasses(const RobotTree& tree);

/// A choice of elastic parameters that was tried, and what it brings on postures that were left
/// out.
struct ElasticityTrial {
  std::string kinds;  ///< "none", "torsion", "torsion and bending"
  /// Of the left-out postures, m; where the root is free, as far as no pose of it explains them.
  double rmse_3d = 0.0;
  /// By how much the mean error of a posture is less than with the choice before, m, and the
  /// standard error of that.
  double gain = 0.0, gain_sd = 0.0;
  Eigen::VectorXd errors;  ///< of each left-out posture, m
  bool chosen = false;
};

/// What the elasticity of the project brings on postures that were left out: `rmse_3d` and
/// `errors`. Nothing where there are too few postures for folds.
std::optional<ElasticityTrial> TryElasticity(const Recording& recording,
                                             std::optional<std::uint64_t> seed, int most_folds,
                                             int threads, const Project& project);

/// Decides on the elasticity of the joints in a table of postures where the project leaves it open:
/// torsion, then bending, enters when it lowers the error of left-out postures (`most_folds` folds,
/// on at most 300 postures) by more than the standard error of that gain, and by more than 2 %.
/// Sets `project.elasticity`; returns what was tried, nothing where there was nothing to decide:
/// trials, whose joints are all elastic anyway; a choice in the project; a robot without masses;
/// fewer than ten postures.
std::vector<ElasticityTrial> ChooseElasticity(const Recording& recording,
                                              std::optional<std::uint64_t> seed, int most_folds,
                                              int threads, Project& project);

}  // namespace elastocal
