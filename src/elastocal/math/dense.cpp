// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/dense.hpp"

#include "elastocal/math/kernels/dense_kernels.hpp"

namespace elastocal {
namespace {

const DenseKernels& Kernels() {
#ifdef ELASTOCAL_KERNELS_V3
  static const bool v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (v3) return kDenseKernelsV3;
#endif
  return kDenseKernels;
}

ConstMatrixView View(const ConstMatrix& A) {
  return {A.data(), A.rows(), A.cols(), A.outerStride()};
}

MatrixView View(Eigen::MatrixXd& A) { return {A.data(), A.rows(), A.cols(), A.outerStride()}; }

}  // namespace

Eigen::MatrixXd Product(const ConstMatrix& A, const ConstMatrix& B) {
  Eigen::MatrixXd C(A.rows(), B.cols());
  Kernels().multiply(View(A), View(B), View(C));
  return C;
}

void AddSquare(double factor, const ConstMatrix& A, Eigen::MatrixXd& S) {
  Kernels().add_square(factor, View(A), View(S));
}

Eigen::MatrixXd InverseOfPositive(const ConstMatrix& S) {
  Eigen::MatrixXd inverse(S.rows(), S.cols());
  Kernels().invert(View(S), View(inverse));
  return inverse;
}

Eigen::MatrixXd SolvePositive(const ConstMatrix& S, const ConstMatrix& B) {
  Eigen::MatrixXd X = B;
  Kernels().solve(View(S), View(X));
  return X;
}

}  // namespace elastocal
