// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace elastocal {

/// Matrices stored by columns. They are not types of Eigen, whose layout differs between
/// processors.
struct ConstMatrixView {
  const double* data;
  std::ptrdiff_t rows, columns, stride;
};
struct MatrixView {
  double* data;
  std::ptrdiff_t rows, columns, stride;
};

/// The operations of dense.hpp for one sort of processor. Results must not overlap the inputs.
struct DenseKernels {
  void (*multiply)(ConstMatrixView A, ConstMatrixView B, MatrixView C);  ///< C = A B
  void (*add_square)(double factor, ConstMatrixView A, MatrixView S);    ///< S += factor A A'
  void (*invert)(ConstMatrixView S, MatrixView inverse);
  void (*solve)(ConstMatrixView S, MatrixView X);  ///< X = S^-1 X
};

extern const DenseKernels kDenseKernels;
extern const DenseKernels kDenseKernelsV3;  ///< for x86-64-v3 alone

}  // namespace elastocal
