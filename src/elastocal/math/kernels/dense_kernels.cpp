// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/kernels/dense_kernels.hpp"

// This file is compiled once more for x86-64-v3. Eigen has another name there; otherwise the linker
// would use one of the two versions for both.
#ifdef ELASTOCAL_FOR_V3
#define Eigen EigenV3
#endif

#include <algorithm>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace elastocal {
namespace {

constexpr Eigen::Index kColumns = 64;  // columns of a triangular matrix that are taken at a time

template <typename Matrix, typename Of>
auto Map(const Of& of) {
  return Eigen::Map<Matrix, 0, Eigen::OuterStride<>>(of.data, of.rows, of.columns,
                                                     Eigen::OuterStride<>(of.stride));
}
auto Mapped(ConstMatrixView of) { return Map<const Eigen::MatrixXd>(of); }
auto Mapped(MatrixView of) { return Map<Eigen::MatrixXd>(of); }

void Multiply(ConstMatrixView A, ConstMatrixView B, MatrixView C) {
  Mapped(C).noalias() = Mapped(A) * Mapped(B);
}

void AddSquare(double factor, ConstMatrixView A, MatrixView S) {
  Mapped(S).selfadjointView<Eigen::Lower>().rankUpdate(Mapped(A), factor);
}

/// Inverts S = L L'. The inverse of L is lower triangular as well, and S^-1 = L^-T L^-1. The zeros
/// of L^-1 are skipped, so that this costs half as much as solving for the columns of the identity.
void Invert(ConstMatrixView S, MatrixView to) {
  const Eigen::LLT<Eigen::MatrixXd> factor(Mapped(S));
  auto inverse = Mapped(to);
  if (factor.info() != Eigen::Success) {
    inverse =
        Eigen::LDLT<Eigen::MatrixXd>(Mapped(S)).solve(Eigen::MatrixXd::Identity(S.rows, S.rows));
    return;
  }
  const Eigen::Index size = S.rows;
  Eigen::MatrixXd root = Eigen::MatrixXd::Identity(size, size);  // L^-1
  inverse.setZero();
  for (Eigen::Index first = 0; first < size; first += kColumns) {
    const Eigen::Index count = std::min(kColumns, size - first);
    auto below = root.block(first, first, size - first, count);
    factor.matrixLLT()
        .bottomRightCorner(size - first, size - first)
        .triangularView<Eigen::Lower>()
        .solveInPlace(below);
  }
  for (Eigen::Index first = 0; first < size; first += kColumns) {
    const Eigen::Index count = std::min(kColumns, size - first);
    const Eigen::Index end = first + count;
    auto corner = inverse.topLeftCorner(end, end);
    corner.selfadjointView<Eigen::Lower>().rankUpdate(root.block(first, 0, count, end).transpose());
  }
  inverse.triangularView<Eigen::StrictlyUpper>() = inverse.transpose();
}

void Solve(ConstMatrixView S, MatrixView X) {
  const Eigen::LLT<Eigen::MatrixXd> factor(Mapped(S));
  auto solution = Mapped(X);
  if (factor.info() == Eigen::Success) {
    factor.solveInPlace(solution);
  } else {
    Eigen::LDLT<Eigen::MatrixXd>(Mapped(S)).solveInPlace(solution);
  }
}

}  // namespace

#ifdef ELASTOCAL_FOR_V3
const DenseKernels kDenseKernelsV3
#else
const DenseKernels kDenseKernels
#endif
    = {Multiply, AddSquare, Invert, Solve};

}  // namespace elastocal
