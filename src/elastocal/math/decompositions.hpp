// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace elastocal {

/// Decompositions of matrices by Eigen. They stand in one place because each of them takes seconds
/// to compile, singular values half a minute.

/// A = U diag(values) V^T with as many columns in U and V as the smaller side of A has (thin); the
/// values descend.
struct SingularValueDecomposition {
  Eigen::MatrixXd U, V;
  Eigen::VectorXd values;
};
SingularValueDecomposition DecomposeSingular(const Eigen::MatrixXd& A);

/// The values alone, which takes less time.
Eigen::VectorXd SingularValues(const Eigen::MatrixXd& A);

/// S = vectors diag(values) vectors^T of a symmetric matrix, of which only the lower triangle is
/// read; the values ascend.
struct SymmetricDecomposition {
  Eigen::MatrixXd vectors;
  Eigen::VectorXd values;
};
SymmetricDecomposition DecomposeSymmetric(const Eigen::MatrixXd& S);

/// The values alone, which takes less time.
Eigen::VectorXd SymmetricValues(const Eigen::MatrixXd& S);

/// R of A = Q R by Householder's reflections, min(rows, columns) x columns.
Eigen::MatrixXd TriangularFactor(const Eigen::MatrixXd& A);

/// Q of A = Q R: rows x rows (OrthogonalFactor), or only its first min(rows, columns) columns
/// (ThinOrthogonalFactor).
Eigen::MatrixXd OrthogonalFactor(const Eigen::MatrixXd& A);
Eigen::MatrixXd ThinOrthogonalFactor(const Eigen::MatrixXd& A);

/// The x that minimises |A x - b|; if there are several, the shortest.
Eigen::VectorXd ShortestSolution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

}  // namespace elastocal
