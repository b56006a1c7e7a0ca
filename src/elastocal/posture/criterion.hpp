// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace elastocal {

/// The observability index that is maximised; see ObservabilityIndices. The paper uses O1 (eq. 12).
enum class Criterion { kO1, kO2, kO3, kO4, kO5 };

/// An index of the information M = Psi^T Psi of several postures, and its derivative.
struct CriterionValue {
  double log_index = 0.0;  ///< natural logarithm; minus infinity if M is singular
  /// Symmetric matrix for which d log_index = sum_i <Psi_i weight, d Psi_i>, with Psi_i of posture
  /// i. Empty if M is singular.
  Eigen::MatrixXd weight;

  bool defined() const { return weight.size() > 0; }
};

/// `information` is columns x columns. O1 is computed by Cholesky, the others by eigenvalues (they
/// have kinks where the extreme singular values are double).
CriterionValue EvaluateCriterion(Criterion criterion, const Eigen::MatrixXd& information,
                                 int postures);

/// log det by Cholesky; minus infinity if the matrix is singular to working precision.
double LogDet(const Eigen::MatrixXd& information);

/// Growth of log det of the information by one more posture: log det(I + Psi M^-1 Psi^T).
double LogGain(const Eigen::LLT<Eigen::MatrixXd>& information, const Eigen::MatrixXd& psi);

/// O1 from log det of the information.
double O1(double log_det, int columns, int postures);

}  // namespace elastocal
