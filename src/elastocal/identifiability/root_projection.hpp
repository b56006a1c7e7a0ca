// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace elastocal {

/// What a posture tells where the root link has an unknown pose of its own in it: P psi, where the
/// rows of psi are those of the posture's markers, and P takes out what displacements of the whole
/// robot explain.
class RootProjection {
 public:
  /// `root`: how the rows change with the pose of the root link (six columns). They may be
  /// dependent, as two markers do not show a rotation about their line.
  explicit RootProjection(const Eigen::MatrixXd& root);

  /// P psi = psi - G G^+ psi with the columns G of the root link.
  Eigen::MatrixXd Apply(const Eigen::MatrixXd& psi) const;

  /// Weights of the columns of psi and of G.
  struct Weights {
    Eigen::MatrixXd psi, root;
  };
  /// Weights with which derivatives of psi and G give that of P psi: sum(weight .* d(P psi)) =
  /// sum(result.psi .* dpsi) + sum(result.root .* dG), as long as the rank of G stays the same.
  Weights Derivative(const Eigen::MatrixXd& psi, const Eigen::MatrixXd& weight) const;

 private:
  Eigen::MatrixXd basis_;    // orthonormal, of the span of G
  Eigen::MatrixXd inverse_;  // G^+
};

}  // namespace elastocal
