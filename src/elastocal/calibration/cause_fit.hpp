// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/linear_study.hpp"

namespace elastocal {

/// Columns of the study that belong to the given causes.
std::vector<int> CauseColumns(const LinearStudy& study, const std::vector<int>& causes);

/// Normal equations in all columns of a study, summed over some of its postures.
struct StudySums {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;

  explicit StudySums(const LinearStudy& study)
      : information(study.other), gradient(study.other_gradient) {}
  /// Adds a posture with `sign` 1; takes it out again with -1.
  void Add(const LinearStudy::Posture& posture, double sign);
};

/// Least-squares fit of the base columns and of the causes taken so far, and what the other columns
/// could still explain beside it.
struct BaseFit {
  std::vector<int> columns, others;
  Eigen::VectorXd step;  ///< solution for `columns`
  /// `columns` x `others`: coefficients by which the base columns reproduce each other column.
  Eigen::MatrixXd explained;
  Eigen::MatrixXd left;      ///< information of the others after the base columns are eliminated
  Eigen::VectorXd gradient;  ///< gradient of the others at the solution

  BaseFit(const LinearStudy& study, const StudySums& sums, const std::vector<int>& taken);
  /// Places of a cause's columns in `others`.
  std::vector<int> Positions(const LinearStudy& study, int cause) const;
  /// Residual of a posture after the fit.
  Eigen::VectorXd Residual(const LinearStudy::Posture& posture) const;
  /// The other columns of a posture, less what the base columns reproduce of them.
  Eigen::MatrixXd Beside(const LinearStudy::Posture& posture) const;
};

/// Fit of one cause beside the base. Its prior is widened as far as the size of the cause requires,
/// by at most 10 (standard deviation), as in the calibration (EstimatePriorScale).
struct CauseFit {
  Eigen::MatrixXd information;  ///< information of the data alone, without the prior
  Eigen::VectorXd step;
  Eigen::MatrixXd covariance;
};

CauseFit FitCause(const LinearStudy& study, const BaseFit& fit, int cause);

}  // namespace elastocal
