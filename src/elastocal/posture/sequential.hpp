// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "elastocal/posture/nocp.hpp"

namespace elastocal {

/// What is known of a problem's parameters before the postures are taken.
struct PriorKnowledge {
  Eigen::MatrixXd covariance;  ///< of all columns of the problem, SI; positive definite
  /// Standard deviation of a sudden change that a parameter may have made, by column; 0: none.
  Eigen::VectorXd change_sd;
  double marker_sd = 3e-4;  ///< of a coordinate, m
};

/// What postures shall tell.
enum class SequentialAim {
  kParameters,  ///< all parameters, beside what is known (Bayesian D-optimality)
  kChanges,     ///< sudden changes, whatever else is uncertain
};

struct SequentialOptions {
  int postures = 8;
  int pool = 300;  ///< random feasible postures to choose from
  int max_rounds = 20;
  SequentialAim aim = SequentialAim::kParameters;
};

/// The information that postures with `data` (sum of Psi'Psi over the variance of a coordinate) are
/// expected to give on the aim, nats: log det(I + L' data L) with the covariance L L'; on changes
/// of standard deviations w, log det(I + w M w) with M the data's information on the changes beside
/// the parameters.
double ExpectedInformation(const PriorKnowledge& prior, const Eigen::MatrixXd& data,
                           SequentialAim aim);

/// Standard deviation with which postures tell a sudden change of each parameter, all else being as
/// uncertain as is known; infinite where no change is expected or nothing tells it.
Eigen::VectorXd ChangeDeviations(const PriorKnowledge& prior, const Eigen::MatrixXd& data);

/// Chooses postures of a pool of random feasible ones: each time the one that gives most
/// information, then any exchange that gives more. The same seed gives the same postures.
/// `DesignResult::indices` has the information after each addition.
DesignResult SequentialDesign(PostureProblem& problem, const PriorKnowledge& prior,
                              std::uint64_t seed, const SequentialOptions& options = {});

}  // namespace elastocal
