// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/dense.hpp"

#include <cmath>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "elastocal/math/kernels/dense_kernels.hpp"
#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

Eigen::MatrixXd RandomMatrix(Eigen::Index rows, Eigen::Index columns) {
  Random random(1);
  return random.NormalVector(rows * columns, 1.0).reshaped(rows, columns);
}

/// An empty matrix, and sizes that are no multiples of the blocks of the kernels.
constexpr int kSizes[] = {0, 1, 3, 64, 65, 203};

TEST(Dense, ProductIsTheSumOverTheInnerIndex) {
  const Eigen::MatrixXd A = (Eigen::MatrixXd(2, 3) << 1, 2, 3, 4, 5, 6).finished();
  const Eigen::MatrixXd B = (Eigen::MatrixXd(3, 2) << 1, 0, -1, 2, 0.5, 1).finished();
  EXPECT_EQ(Product(A, B), (Eigen::MatrixXd(2, 2) << 0.5, 7, 2, 16).finished());
  for (int size : kSizes) {
    const Eigen::MatrixXd C = RandomMatrix(size, 2 * size), D = RandomMatrix(2 * size, size + 1);
    // The sums have 400 terms of the order of one.
    EXPECT_LT((Product(C, D) - C.lazyProduct(D)).norm(), 1e-12 * (1.0 + C.norm() * D.norm()));
  }
}

TEST(Dense, ReadsAPartOfAMatrix) {
  const Eigen::MatrixXd A = RandomMatrix(9, 7);
  EXPECT_LT((Product(A.block(1, 2, 5, 4), A.block(3, 0, 4, 6)) -
             A.block(1, 2, 5, 4).lazyProduct(A.block(3, 0, 4, 6)))
                .norm(),
            1e-13);
}

TEST(Dense, AddSquareKeepsWhatIsAboveTheDiagonal) {
  for (int size : kSizes) {
    const Eigen::MatrixXd A = RandomMatrix(size, size + 5);
    const Eigen::MatrixXd before = RandomMatrix(size, size);
    Eigen::MatrixXd S = before;
    AddSquare(-0.5, A, S);
    const Eigen::MatrixXd whole = before - 0.5 * A.lazyProduct(A.transpose());
    const Eigen::MatrixXd left = S - whole;
    EXPECT_LT(left.triangularView<Eigen::Lower>().toDenseMatrix().norm(), 1e-12 * (1 + A.norm()));
    const Eigen::MatrixXd above = S - before;
    EXPECT_TRUE(above.triangularView<Eigen::StrictlyUpper>().toDenseMatrix().isZero(0.0));
  }
}

TEST(Dense, InverseAndSolutionOfAPositiveMatrix) {
  for (int size : kSizes) {
    const Eigen::MatrixXd A = RandomMatrix(size, size);
    Eigen::MatrixXd S = A * A.transpose() + Eigen::MatrixXd::Identity(size, size);
    Eigen::MatrixXd lower = S;  // the entries above the diagonal must not be read
    lower.triangularView<Eigen::StrictlyUpper>().setConstant(7.0);
    const Eigen::MatrixXd inverse = InverseOfPositive(lower);
    // The condition number is some hundreds.
    EXPECT_LT((S * inverse - Eigen::MatrixXd::Identity(size, size)).norm(), 1e-11);
    EXPECT_EQ(inverse, inverse.transpose());
    const Eigen::MatrixXd B = RandomMatrix(size, 2);
    EXPECT_LT((S * SolvePositive(lower, B) - B).norm(), 1e-11);
  }
}

// Rounding can make a badly conditioned matrix indefinite. Callers still need finite numbers.
TEST(Dense, AMatrixThatIsNotPositiveHasItsInverseAllTheSame) {
  const Eigen::MatrixXd S = (Eigen::MatrixXd(2, 2) << 1, 2, 2, 1).finished();
  const Eigen::MatrixXd inverse = (Eigen::MatrixXd(2, 2) << -1, 2, 2, -1).finished() / 3.0;
  EXPECT_LT((InverseOfPositive(S) - inverse).norm(), 1e-15);
  const Eigen::MatrixXd B = (Eigen::MatrixXd(2, 1) << 3, -1).finished();
  EXPECT_LT((SolvePositive(S, B) - inverse * B).norm(), 1e-15);
}

// An old processor would run the other kernels, which no other test here covers.
TEST(Dense, KernelsForAnyProcessorAgree) {
  constexpr Eigen::Index kSize = 150;
  const Eigen::MatrixXd A = RandomMatrix(kSize, kSize);
  const Eigen::MatrixXd S = A * A.transpose() + Eigen::MatrixXd::Identity(kSize, kSize);
  const auto view = [](const Eigen::MatrixXd& of) {
    return ConstMatrixView{of.data(), of.rows(), of.cols(), of.rows()};
  };
  const auto to = [](Eigen::MatrixXd& of) {
    return MatrixView{of.data(), of.rows(), of.cols(), of.rows()};
  };
  Eigen::MatrixXd result(kSize, kSize);
  kDenseKernels.multiply(view(A), view(S), to(result));
  EXPECT_LT((result - Product(A, S)).norm(), 1e-13 * A.norm() * S.norm());
  kDenseKernels.invert(view(S), to(result));
  EXPECT_LT((result - InverseOfPositive(S)).norm(), 1e-11);
  result = A;
  kDenseKernels.solve(view(S), to(result));
  EXPECT_LT((result - SolvePositive(S, A)).norm(), 1e-10);
  Eigen::MatrixXd sum = S;
  result = S;
  AddSquare(2.0, A, sum);
  kDenseKernels.add_square(2.0, view(A), to(result));
  EXPECT_LT((result - sum).norm(), 1e-13 * S.norm());
}

}  // namespace
}  // namespace elastocal
