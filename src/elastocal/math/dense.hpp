// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace elastocal {

/// The operations on large dense matrices that an estimate spends most of its time in. They are
/// compiled twice, for any processor and for one with AVX2 and FMA (x86-64-v3), and the processor
/// that the program runs on decides. So bits may differ between the two sorts of processors, by
/// rounding, and by nothing else.

using ConstMatrix = Eigen::Ref<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

/// A B.
Eigen::MatrixXd Product(const ConstMatrix& A, const ConstMatrix& B);

/// Adds `factor` A A^T to the lower triangle of a symmetric matrix S; what is above stays.
void AddSquare(double factor, const ConstMatrix& A, Eigen::MatrixXd& S);

/// S^-1 of a symmetric positive definite matrix, whose lower triangle alone is read: by LL', and by
/// LDL' where rounding has made it indefinite.
Eigen::MatrixXd InverseOfPositive(const ConstMatrix& S);

/// S^-1 B, likewise.
Eigen::MatrixXd SolvePositive(const ConstMatrix& S, const ConstMatrix& B);

}  // namespace elastocal
