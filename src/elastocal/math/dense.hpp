// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace elastocal {

/// The operations on large dense matrices in which an estimate spends most of its time. They are
/// compiled twice, for any processor and for processors with AVX2 and FMA (x86-64-v3). The program
/// chooses by the processor that it runs on. Results on the two sorts of processors may differ by
/// rounding.

using ConstMatrix = Eigen::Ref<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

/// A B.
Eigen::MatrixXd Product(const ConstMatrix& A, const ConstMatrix& B);

/// Adds `factor` A A^T to the lower triangle of a symmetric matrix S; the part above it stays.
void AddSquare(double factor, const ConstMatrix& A, Eigen::MatrixXd& S);

/// S^-1 of a symmetric positive definite matrix, of which only the lower triangle is read. It uses
/// LL', or LDL' if rounding has made S indefinite.
Eigen::MatrixXd InverseOfPositive(const ConstMatrix& S);

/// S^-1 B, with S as for InverseOfPositive.
Eigen::MatrixXd SolvePositive(const ConstMatrix& S, const ConstMatrix& B);

}  // namespace elastocal
