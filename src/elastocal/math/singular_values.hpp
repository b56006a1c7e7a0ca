#pragma once

#include <Eigen/Core>

namespace elastocal {

/// A = U diag(values) V^T with as many columns in U and V as the smaller side of A has (thin); the
/// values descend. In one place because Eigen's decomposition takes a minute to compile.
struct SingularValueDecomposition {
  Eigen::MatrixXd U, V;
  Eigen::VectorXd values;
};

SingularValueDecomposition DecomposeSingular(const Eigen::MatrixXd& A);

/// The values alone, which takes less time.
Eigen::VectorXd SingularValues(const Eigen::MatrixXd& A);

}  // namespace elastocal
