// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// Which columns of a matrix are linearly independent of those before them, and how the other
/// columns follow from these.
struct PriorityQrResult {
  /// Kept and dropped columns, each in ascending order; together all columns.
  std::vector<int> kept, dropped;
  /// kept x dropped: A(:, dropped) = A(:, kept) * regrouping. Therefore A x determines only
  /// the combination x(kept) + regrouping * x(dropped).
  Eigen::MatrixXd regrouping;
  /// Norm of the part of each column that is orthogonal to the kept columns before it, relative to
  /// the column's own norm (0 for a column that is zero up to rounding).
  Eigen::VectorXd remainder;
};

/// 1 / norm of each column, to scale columns to unit norm; 0 for a column shorter than 1e-12 of the
/// longest. Such a column is zero up to rounding, and scaling would blow the rounding up to a
/// column.
Eigen::VectorXd InverseColumnNorms(const Eigen::MatrixXd& A);

/// QR decomposition without pivoting, column by column (Gautier 1990; paper section 2.1): the
/// first columns have priority. A column is kept when its `remainder` exceeds `tolerance`.
/// Throws std::invalid_argument for a tolerance outside (0, 1).
PriorityQrResult PriorityQr(const Eigen::MatrixXd& A, double tolerance);

}  // namespace elastocal
