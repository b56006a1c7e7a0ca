// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/decompositions.hpp"

#include <algorithm>
#include <limits>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace elastocal {

SingularValueDecomposition DecomposeSingular(const Eigen::MatrixXd& A) {
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {svd.matrixU(), svd.matrixV(), svd.singularValues()};
}

Eigen::VectorXd SingularValues(const Eigen::MatrixXd& A) {
  return Eigen::BDCSVD<Eigen::MatrixXd>(A).singularValues();
}

SymmetricDecomposition DecomposeSymmetric(const Eigen::MatrixXd& S) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(S);
  return {eigen.eigenvectors(), eigen.eigenvalues()};
}

Eigen::VectorXd SymmetricValues(const Eigen::MatrixXd& S) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(S, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigen::MatrixXd TriangularFactor(const Eigen::MatrixXd& A) {
  const Eigen::Index size = std::min(A.rows(), A.cols());
  return Eigen::HouseholderQR<Eigen::MatrixXd>(A)
      .matrixQR()
      .topRows(size)
      .triangularView<Eigen::Upper>();
}

Eigen::MatrixXd OrthogonalFactor(const Eigen::MatrixXd& A) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(A).householderQ();
}

Eigen::MatrixXd ThinOrthogonalFactor(const Eigen::MatrixXd& A) {
  const Eigen::Index size = std::min(A.rows(), A.cols());
  return Eigen::HouseholderQR<Eigen::MatrixXd>(A).householderQ() *
         Eigen::MatrixXd::Identity(A.rows(), size);
}

Eigen::VectorXd ShortestSolution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  const SingularValueDecomposition svd = DecomposeSingular(A);
  const double floor = std::numeric_limits<double>::epsilon() *
                       static_cast<double>(svd.values.size()) * svd.values.maxCoeff();
  const Eigen::ArrayXd values = svd.values.array();
  const Eigen::VectorXd inverse = (values > floor).select(values.inverse(), 0.0);
  return svd.V * inverse.cwiseProduct(svd.U.transpose() * b);
}

}  // namespace elastocal
