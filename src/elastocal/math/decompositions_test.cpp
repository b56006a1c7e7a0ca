// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/decompositions.hpp"

#include <gtest/gtest.h>

namespace elastocal {
namespace {

TEST(Decompositions, SingularValuesByHand) {
  Eigen::MatrixXd A(3, 2);
  A << 3, 0, 0, -4, 0, 0;
  EXPECT_LT((SingularValues(A) - Eigen::Vector2d(4, 3)).norm(), 1e-14);
  const SingularValueDecomposition svd = DecomposeSingular(A);
  EXPECT_EQ(svd.U.cols(), 2);
  EXPECT_LT((svd.U * svd.values.asDiagonal() * svd.V.transpose() - A).norm(), 1e-14);
}

TEST(Decompositions, EigenvaluesByHandFromTheLowerTriangle) {
  Eigen::MatrixXd S(2, 2);
  S << 2, 99, 1, 2;
  EXPECT_LT((SymmetricValues(S) - Eigen::Vector2d(1, 3)).norm(), 1e-14);
  const SymmetricDecomposition of = DecomposeSymmetric(S);
  EXPECT_LT((of.values - Eigen::Vector2d(1, 3)).norm(), 1e-14);
  EXPECT_NEAR(std::abs(of.vectors.col(1).dot(Eigen::Vector2d(1, 1))), std::sqrt(2.0), 1e-14);
}

TEST(Decompositions, FactorsOfTallAndWide) {
  for (const auto& [rows, columns] : {std::pair(5, 3), std::pair(3, 5)}) {
    const Eigen::MatrixXd A = Eigen::MatrixXd::NullaryExpr(
        rows, columns, [](Eigen::Index i, Eigen::Index j) { return std::sin(1.0 + i + 3.0 * j); });
    const Eigen::MatrixXd R = TriangularFactor(A);
    const Eigen::MatrixXd Q = OrthogonalFactor(A);
    ASSERT_EQ(R.rows(), 3);
    ASSERT_EQ(Q.cols(), rows);
    EXPECT_EQ(R(2, 1), 0.0);
    EXPECT_LT((Q.leftCols(3) * R - A).norm(), 1e-14);
    EXPECT_LT((Q.transpose() * Q - Eigen::MatrixXd::Identity(rows, rows)).norm(), 1e-14);
    EXPECT_LT((ThinOrthogonalFactor(A) - Q.leftCols(3)).norm(), 1e-14);
  }
}

TEST(Decompositions, TheShortestOfSeveralSolutions) {
  const Eigen::MatrixXd A = Eigen::RowVector2d(3, 4);
  const Eigen::VectorXd x = ShortestSolution(A, Eigen::VectorXd::Constant(1, 25.0));
  EXPECT_LT((x - Eigen::Vector2d(3, 4)).norm(), 1e-14);
}

}  // namespace
}  // namespace elastocal
