// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/linear_study.hpp"

namespace elastocal {

/// Columns of causes in a study.
std::vector<int> CauseColumns(const LinearStudy& study, const std::vector<int>& causes);

/// Normal equations in all columns of a study, over some of its postures.
struct StudySums {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;

  explicit StudySums(const LinearStudy& study)
      : information(study.other), gradient(study.other_gradient) {}
  /// `sign`: -1 takes the posture out again.
  void Add(const LinearStudy::Posture& posture, double sign);
};

/// The fit of the base, with the causes taken so far, to what is in the sums, and the columns of
/// all others beside it.
struct BaseFit {
  std::vector<int> columns, others;
  Eigen::VectorXd step;       ///< of the base
  Eigen::MatrixXd explained;  ///< base x others: what the base makes of each
  Eigen::MatrixXd left;       ///< information of the others beside the base
  Eigen::VectorXd gradient;   ///< of the others beside the base

  BaseFit(const LinearStudy& study, const StudySums& sums, const std::vector<int>& taken);
  /// Where the columns of a cause stand among the others.
  std::vector<int> Positions(const LinearStudy& study, int cause) const;
  Eigen::VectorXd Residual(const LinearStudy::Posture& posture) const;
  Eigen::MatrixXd Beside(const LinearStudy::Posture& posture) const;
};

/// A cause fitted beside the base: its prior is widened as far as its size asks for, like that of
/// the calibration (EstimatePriorScale).
struct CauseFit {
  Eigen::MatrixXd information;  ///< of the data alone
  Eigen::VectorXd step;
  Eigen::MatrixXd covariance;
};

CauseFit FitCause(const LinearStudy& study, const BaseFit& fit, int cause);

}  // namespace elastocal
