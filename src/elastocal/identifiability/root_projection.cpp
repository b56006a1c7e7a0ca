// SPDX-License-Identifier: Apache-2.0
#include "elastocal/identifiability/root_projection.hpp"

#include "elastocal/math/decompositions.hpp"

namespace elastocal {

RootProjection::RootProjection(const Eigen::MatrixXd& root) {
  constexpr double kDependent = 1e-9;
  const SingularValueDecomposition svd = DecomposeSingular(root);
  const Eigen::Index rank = (svd.values.array() > kDependent * svd.values[0]).count();
  basis_ = svd.U.leftCols(rank);
  inverse_ =
      svd.V.leftCols(rank) * svd.values.head(rank).cwiseInverse().asDiagonal() * basis_.transpose();
}

Eigen::MatrixXd RootProjection::Apply(const Eigen::MatrixXd& psi) const {
  return psi - basis_ * (basis_.transpose() * psi);
}

RootProjection::Weights RootProjection::Derivative(const Eigen::MatrixXd& psi,
                                                   const Eigen::MatrixXd& weight) const {
  // dP = -(P dG G^+ + its transpose).
  const Eigen::MatrixXd kept = Apply(weight);
  return {kept,
          -kept * (inverse_ * psi).transpose() - Apply(psi) * (inverse_ * weight).transpose()};
}

}  // namespace elastocal
