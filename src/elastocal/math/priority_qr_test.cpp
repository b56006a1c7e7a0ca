// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/priority_qr.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

using Eigen::MatrixXd;
using Indices = std::vector<int>;

constexpr double kTolerance = 1e-6;
// Accumulated rounding of numbers near 1 in matrices of some ten columns.
constexpr double kQrRounding = 1e-13;

MatrixXd RandomMatrix(int rows, int cols, std::uint64_t seed) {
  return Random(seed).NormalVector(rows * cols, 1.0).reshaped(rows, cols);
}

/// Product of random factors: its rank is `rank`, and any `rank` columns are independent.
MatrixXd LowRank(int rows, int cols, int rank, std::uint64_t seed) {
  return RandomMatrix(rows, rank, seed) * RandomMatrix(rank, cols, seed + 1);
}

void ExpectRegrouping(const MatrixXd& A, const PriorityQrResult& qr, double tolerance) {
  ASSERT_EQ(qr.regrouping.rows(), static_cast<Eigen::Index>(qr.kept.size()));
  ASSERT_EQ(qr.regrouping.cols(), static_cast<Eigen::Index>(qr.dropped.size()));
  const MatrixXd error = A(Eigen::all, qr.dropped) - A(Eigen::all, qr.kept) * qr.regrouping;
  EXPECT_TRUE(error.size() == 0 || error.cwiseAbs().maxCoeff() < tolerance * A.norm()) << error;
}

TEST(PriorityQr, ByHand) {
  // c = 2 a + 3 b; d is 45 degrees out of the plane of the others.
  MatrixXd A(3, 4);
  A << 1, 1, 5, 0,  //
      0, 2, 6, 1,   //
      0, 0, 0, 1;
  const PriorityQrResult qr = PriorityQr(A, kTolerance);
  EXPECT_EQ(qr.kept, (Indices{0, 1, 3}));
  EXPECT_EQ(qr.dropped, Indices{2});
  EXPECT_LT((qr.regrouping - Eigen::Vector3d(2, 3, 0)).norm(), kQrRounding);
  const Eigen::Vector4d remainder(1.0, 2.0 / std::sqrt(5.0), 0.0, std::sqrt(0.5));
  EXPECT_LT((qr.remainder - remainder).norm(), kQrRounding);
}

TEST(PriorityQr, TheFirstColumnsWin) {
  const Eigen::MatrixXd A = LowRank(20, 6, 3, 1);
  EXPECT_EQ(PriorityQr(A, kTolerance).kept, (Indices{0, 1, 2}));
  MatrixXd B = A;
  B.col(1) = 2.0 * A.col(0);  // now the fourth column is needed
  EXPECT_EQ(PriorityQr(B, kTolerance).kept, (Indices{0, 2, 3}));
  EXPECT_EQ(PriorityQr(B, kTolerance).dropped, (Indices{1, 4, 5}));
}

TEST(PriorityQr, DroppedColumnsFollowFromTheKept) {
  for (int seed = 1; seed <= 20; ++seed) {
    const MatrixXd A = LowRank(30, 12, 7, 10 * seed);
    const PriorityQrResult qr = PriorityQr(A, kTolerance);
    EXPECT_EQ(qr.kept.size(), 7u);
    // Random square matrices have condition numbers up to about 1e3.
    ExpectRegrouping(A, qr, 1e3 * kQrRounding);
  }
}

TEST(PriorityQr, UnitsOfColumnsDoNotMatter) {
  const MatrixXd A = LowRank(15, 8, 5, 3);
  Eigen::VectorXd units(8);
  units << 1e-3, 1e3, 1.0, 1e2, 1e-3, 1e-4, 1e4, 1.0;
  const PriorityQrResult a = PriorityQr(A, kTolerance);
  const PriorityQrResult b = PriorityQr(A * units.asDiagonal(), kTolerance);
  EXPECT_EQ(a.kept, b.kept);
  EXPECT_LT((a.remainder - b.remainder).norm(), kQrRounding);
  const MatrixXd expected =
      units(a.kept).cwiseInverse().asDiagonal() * a.regrouping * units(a.dropped).asDiagonal();
  // The entries are compared one by one because they range from 1e-8 to 1e8.
  EXPECT_LT((b.regrouping.cwiseQuotient(expected).array() - 1.0).abs().maxCoeff(), 1e-9);
}

TEST(PriorityQr, AZeroColumnIsDroppedIntoNothing) {
  MatrixXd A = RandomMatrix(5, 3, 5);
  A.col(1).setZero();
  const PriorityQrResult qr = PriorityQr(A, kTolerance);
  EXPECT_EQ(qr.kept, (Indices{0, 2}));
  EXPECT_EQ(qr.remainder[1], 0.0);
  EXPECT_EQ(qr.regrouping, (MatrixXd::Zero(2, 1)));
}

TEST(PriorityQr, RoundingIsNoColumn) {
  // A rotation about an axis through the point that it should move gives such a column.
  MatrixXd A = RandomMatrix(5, 3, 5);
  A.col(1) *= 1e-16;
  const PriorityQrResult qr = PriorityQr(A, kTolerance);
  EXPECT_EQ(qr.kept, (Indices{0, 2}));
  EXPECT_EQ(qr.remainder[1], 0.0);
}

TEST(PriorityQr, TheToleranceIsRelativeToTheColumn) {
  // The second column differs by 1e-4 from the direction of the first, whatever its length.
  MatrixXd A(2, 2);
  A << 1, 50, 0, 50e-4;
  EXPECT_EQ(PriorityQr(A, 0.9e-4).kept.size(), 2u);
  EXPECT_EQ(PriorityQr(A, 1.1e-4).kept.size(), 1u);
}

TEST(PriorityQr, WideMatrix) {
  const MatrixXd A = RandomMatrix(4, 9, 7);
  const PriorityQrResult qr = PriorityQr(A, kTolerance);
  EXPECT_EQ(qr.kept, (Indices{0, 1, 2, 3}));
  ExpectRegrouping(A, qr, 1e3 * kQrRounding);
}

TEST(PriorityQr, WithoutRowsOrColumns) {
  EXPECT_EQ(PriorityQr(MatrixXd(0, 3), kTolerance).dropped, (Indices{0, 1, 2}));
  EXPECT_TRUE(PriorityQr(MatrixXd(3, 0), kTolerance).kept.empty());
}

TEST(PriorityQr, RefusesToleranceOutsideZeroToOne) {
  for (double tolerance : {0.0, 1.0, -1e-6, std::nan("")}) {
    EXPECT_THROW(PriorityQr(MatrixXd::Identity(2, 2), tolerance), std::invalid_argument);
  }
}

}  // namespace
}  // namespace elastocal
