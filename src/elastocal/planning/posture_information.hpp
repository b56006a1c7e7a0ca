// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/observation/observation_residuals.hpp"

namespace elastocal {

/// Information of several postures beside a prior, to choose the best of them.
class PostureInformation {
 public:
  /// Takes evaluated residuals, whose first blocks are the observations and whose other blocks are
  /// the prior. `posture` is the posture of each observation, from 0 to `count` - 1.
  PostureInformation(const ObservationResiduals& residuals, const std::vector<int>& posture,
                     int count);

  int count() const { return static_cast<int>(rows_.size()); }

  /// Information of a set of postures, nats: half the logarithm of det(prior + sum J^T J) /
  /// det(prior).
  double Of(const std::vector<int>& postures) const;

  /// For each unknown: information of these postures about a change of it alone that the prior does
  /// not contain. It is the diagonal of A - A (A + P^-1)^-1 A, with A the sum of J^T J and P the
  /// prior's covariance.
  Eigen::VectorXd OfChanges(const std::vector<int>& postures) const;

  /// The best `count` postures, each used once: chosen greedily, then each exchanged once for the
  /// best one beside the others.
  std::vector<int> Choose(int count) const;

 private:
  /// Adds a posture to a covariance (removes it with `sign` -1) and returns the gain.
  double Update(int posture, double sign, Eigen::MatrixXd& covariance) const;
  double Gain(int posture, const Eigen::MatrixXd& covariance) const;
  int Best(const Eigen::MatrixXd& covariance, const std::vector<char>& taken) const;

  // By posture: rows in units of the prior's standard deviations.
  std::vector<Eigen::MatrixXd> rows_;
  Eigen::MatrixXd prior_;  // covariance of the prior
};

}  // namespace elastocal
