// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace elastocal {

/// Projection of the rows of one posture for a root link that has an unknown pose of its own in it:
/// P psi, where psi has the rows of the posture's markers and P removes what displacements of the
/// whole robot explain.
class RootProjection {
 public:
  /// `root` is the matrix G of derivatives of the rows by the pose of the root link (six columns).
  /// Its columns may be dependent: two markers do not show a rotation about their line.
  explicit RootProjection(const Eigen::MatrixXd& root);

  /// P psi = psi - G G^+ psi with the columns G of the root link.
  Eigen::MatrixXd Apply(const Eigen::MatrixXd& psi) const;

  /// Weights of the columns of psi and of G.
  struct Weights {
    Eigen::MatrixXd psi, root;
  };
  /// Derivative of sum(weight .* P psi), expressed by those of psi and G: sum(weight .* d(P psi)) =
  /// sum(result.psi .* dpsi) + sum(result.root .* dG), as long as the rank of G stays the same.
  Weights Derivative(const Eigen::MatrixXd& psi, const Eigen::MatrixXd& weight) const;

 private:
  Eigen::MatrixXd basis_;    // orthonormal, of the span of G
  Eigen::MatrixXd inverse_;  // G^+
};

}  // namespace elastocal
