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

/// What the postures are chosen to determine.
enum class SequentialAim {
  kParameters,  ///< all parameters, given the prior knowledge (Bayesian D-optimality)
  kChanges,     ///< sudden changes, while all else is as uncertain as the prior says
};

struct SequentialOptions {
  int postures = 8;
  int pool = 300;  ///< random feasible postures to choose from
  int max_rounds = 20;
  SequentialAim aim = SequentialAim::kParameters;
};

/// Information that postures are expected to give on the aim, nats. `data` is the sum of Psi'Psi
/// over the variance of a marker coordinate.
/// - kParameters: log det(I + L' data L) with the prior covariance L L';
/// - kChanges: log det(I + w M w) with the standard deviations w of the changes and the information
///   M of the data on the changes, when the parameters are as uncertain as the prior says.
double ExpectedInformation(const PriorKnowledge& prior, const Eigen::MatrixXd& data,
                           SequentialAim aim);

/// Standard deviation with which postures determine a sudden change of each parameter, while all
/// else is as uncertain as the prior says. Infinite if no change is expected or the data do not
/// determine it.
Eigen::VectorXd ChangeDeviations(const PriorKnowledge& prior, const Eigen::MatrixXd& data);

/// Chooses postures from a pool of random feasible ones. It adds the posture that gives most
/// information (ExpectedInformation), one after the other, and then exchanges postures as long as
/// this gives more. The same seed gives the same postures. `DesignResult::indices` has the
/// information after each addition, nats.
DesignResult SequentialDesign(PostureProblem& problem, const PriorKnowledge& prior,
                              std::uint64_t seed, const SequentialOptions& options = {});

}  // namespace elastocal
