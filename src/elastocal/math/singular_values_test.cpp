#include "elastocal/math/singular_values.hpp"

#include <gtest/gtest.h>

namespace elastocal {
namespace {

TEST(SingularValues, OfAMatrixByHand) {
  Eigen::MatrixXd A(3, 2);
  A << 3, 0, 0, -4, 0, 0;
  EXPECT_LT((SingularValues(A) - Eigen::Vector2d(4, 3)).norm(), 1e-14);
  const SingularValueDecomposition svd = DecomposeSingular(A);
  EXPECT_EQ(svd.U.cols(), 2);
  EXPECT_LT((svd.U * svd.values.asDiagonal() * svd.V.transpose() - A).norm(), 1e-14);
}

}  // namespace
}  // namespace elastocal
