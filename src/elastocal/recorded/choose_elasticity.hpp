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

/// Whether the robot description has masses of moved links.
bool HasMasses(const RobotTree& tree);

/// A choice of elastic parameters that was tried, and its errors on held-out postures.
struct ElasticityTrial {
  std::string kinds;  ///< "none", "torsion", "torsion and bending"
  /// Error on the held-out postures, m. Where the root is free, its pose in each of them is fitted
  /// to all markers.
  double rmse_3d = 0.0;
  /// By how much the mean error of a posture is smaller than with the best choice before, m, and
  /// the standard error of that.
  double gain = 0.0, gain_sd = 0.0;
  Eigen::VectorXd errors;  ///< error of each held-out posture, m
  bool chosen = false;
};

/// Errors on held-out postures with the elasticity of the project: `rmse_3d` and `errors`. Nothing
/// where there are too few postures for folds.
std::optional<ElasticityTrial> TryElasticity(const Recording& recording,
                                             std::optional<std::uint64_t> seed, int most_folds,
                                             int threads, const Project& project);

/// Chooses the elasticity of the joints in a posture table, where the project leaves it open.
/// Torsion, and then torsion with bending, is taken if it lowers the mean error of held-out
/// postures (`most_folds` folds, on at most 300 postures) by more than the standard error of that
/// gain, and by more than 2 %. Sets `project.elasticity` and returns what was tried. Empty where
/// there is nothing to choose: for trials, whose joints are all elastic; with a choice in the
/// project; for a robot without masses; for fewer than five postures.
std::vector<ElasticityTrial> ChooseElasticity(const Recording& recording,
                                              std::optional<std::uint64_t> seed, int most_folds,
                                              int threads, Project& project);

}  // namespace elastocal
