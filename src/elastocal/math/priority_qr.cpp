// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/priority_qr.hpp"

#include <stdexcept>

#include "elastocal/math/decompositions.hpp"

namespace elastocal {

Eigen::VectorXd InverseColumnNorms(const Eigen::MatrixXd& A) {
  const Eigen::VectorXd norms = A.colwise().norm();
  const double floor = norms.size() > 0 ? 1e-12 * norms.maxCoeff() : 0.0;
  return norms.unaryExpr([&](double norm) { return norm > floor ? 1.0 / norm : 0.0; });
}

PriorityQrResult PriorityQr(const Eigen::MatrixXd& A, double tolerance) {
  if (!(tolerance > 0.0 && tolerance < 1.0)) {
    throw std::invalid_argument("PriorityQr: the tolerance must lie between 0 and 1");
  }
  // With columns of unit norm, one tolerance fits all. R has the same column relations as A.
  const Eigen::VectorXd norms = A.colwise().norm();
  const Eigen::VectorXd inverse_norms = InverseColumnNorms(A);
  const Eigen::Index size = std::min(A.rows(), A.cols());
  Eigen::MatrixXd R = TriangularFactor(A * inverse_norms.asDiagonal());

  // Orthonormal basis of the kept columns, grown one by one; projecting twice keeps it orthogonal.
  PriorityQrResult result;
  result.remainder.resize(A.cols());
  Eigen::MatrixXd basis(size, size);
  for (int column = 0; column < A.cols(); ++column) {
    const auto Q = basis.leftCols(static_cast<Eigen::Index>(result.kept.size()));
    Eigen::VectorXd rest = R.col(column);
    for (int pass = 0; pass < 2; ++pass) rest -= Q * (Q.transpose() * rest);
    result.remainder[column] = rest.norm();
    if (rest.norm() > tolerance && Q.cols() < size) {
      basis.col(Q.cols()) = rest.normalized();
      result.kept.push_back(column);
    } else {
      result.dropped.push_back(column);
    }
  }

  const auto kept_count = static_cast<Eigen::Index>(result.kept.size());
  const auto dropped_count = static_cast<Eigen::Index>(result.dropped.size());
  result.regrouping.resize(kept_count, dropped_count);
  if (result.regrouping.size() == 0) return result;  // Eigen's solver takes no empty matrix
  const Eigen::MatrixXd Q = basis.leftCols(kept_count);
  const Eigen::MatrixXd R_kept = Q.transpose() * R(Eigen::all, result.kept);
  const Eigen::MatrixXd scaled = R_kept.triangularView<Eigen::Upper>().solve(
      Eigen::MatrixXd(Q.transpose() * R(Eigen::all, result.dropped)));
  result.regrouping =
      inverse_norms(result.kept).asDiagonal() * scaled * norms(result.dropped).asDiagonal();
  return result;
}

}  // namespace elastocal
