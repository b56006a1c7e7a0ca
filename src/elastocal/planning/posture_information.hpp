// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/observation/observation_residuals.hpp"

namespace elastocal {

/// What each of several postures tells beside a prior, to choose the best of them.
class PostureInformation {
 public:
  /// From evaluated residuals, whose first blocks are the observations; `posture`: by observation,
  /// from 0 to `count` - 1. The blocks that follow are the prior.
  PostureInformation(const ObservationResiduals& residuals, const std::vector<int>& posture,
                     int count);

  int count() const { return static_cast<int>(rows_.size()); }

  /// Information of a set of postures, nats: half the logarithm of det(prior + sum J^T J) /
  /// det(prior).
  double Of(const std::vector<int>& postures) const;

  /// By unknown, what these postures say of a change of it alone that the prior does not know of:
  /// the diagonal of A - A (A + P^-1)^-1 A, with A the sum of J^T J and P the prior's covariance.
  Eigen::VectorXd OfChanges(const std::vector<int>& postures) const;

  /// The best of the postures, `count` of them, each once: greedily, and then each of them
  /// exchanged once for what is best beside the others.
  std::vector<int> Choose(int count) const;

 private:
  /// Adds a posture to a covariance (or takes it away: `sign` -1) and returns the gain.
  double Update(int posture, double sign, Eigen::MatrixXd& covariance) const;
  double Gain(int posture, const Eigen::MatrixXd& covariance) const;
  int Best(const Eigen::MatrixXd& covariance, const std::vector<char>& taken) const;

  std::vector<Eigen::MatrixXd> rows_;  // by posture: over the prior's standard deviations
  Eigen::MatrixXd prior_;              // covariance
};

}  // namespace elastocal
