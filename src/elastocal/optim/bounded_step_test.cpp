// SPDX-License-Identifier: Apache-2.0
#include "elastocal/optim/bounded_step.hpp"

#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

TEST(BoundedStep, StopsAtZeroAndLeavesItAgain) {
  // The cost is (d0 - 1)^2 + (d0 + d1)^2 from x = (0, 0.25). If d1 is free, it is -1, which would
  // make x1 = -0.75.
  Eigen::Matrix2d H;
  H << 4, 2, 2, 2;
  const Eigen::Vector2d g(-2, 0);
  const Eigen::Vector2d x(0.0, 0.25);
  EXPECT_LT((BoundedStep(H, g, x, {}) - Eigen::Vector2d(1, -1)).norm(), 1e-12);
  // If d1 is held at -0.25, then 2 (d0 - 1) + 2 (d0 - 0.25) = 0.
  EXPECT_LT((BoundedStep(H, g, x, {1}) - Eigen::Vector2d(0.625, -0.25)).norm(), 1e-12);
  // At the bound, an unknown whose cost falls outwards is held at once. One whose cost falls
  // inwards is free.
  EXPECT_EQ(BoundedStep(H, Eigen::Vector2d(2, 0), Eigen::Vector2d(0, 5), {0}),
            Eigen::Vector2d(0, 0));
  EXPECT_LT((BoundedStep(H, g, Eigen::Vector2d(0, 5), {0}) - Eigen::Vector2d(1, -1)).norm(), 1e-12);
}

// There are half as many data as unknowns, and a weak prior. The set of unknowns at the bound
// changes many times before the best set is found. (If all candidates changed at once, it would go
// round in circles.)
TEST(BoundedStep, IsTheMinimumWhereThePriorTellsManyUnknowns) {
  constexpr Eigen::Index kSize = 120, kData = 60;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    Eigen::MatrixXd A(kData, kSize);
    for (Eigen::Index c = 0; c < kSize; ++c) A.col(c) = random.NormalVector(kData, 1.0);
    const Eigen::MatrixXd H = A.transpose() * A + 1e-3 * Eigen::MatrixXd::Identity(kSize, kSize);
    const Eigen::VectorXd g = A.transpose() * random.NormalVector(kData, 1.0);
    const Eigen::VectorXd x = random.NormalVector(kSize, 0.1).cwiseMax(0.0);
    std::vector<int> all(kSize);
    std::iota(all.begin(), all.end(), 0);
    const Eigen::VectorXd step = BoundedStep(H, g, x, all);
    const Eigen::VectorXd slope = g + H * step;
    for (Eigen::Index i = 0; i < kSize; ++i) {
      const double there = x[i] + step[i];
      EXPECT_GE(there, 0.0);
      // At the bound the cost rises inwards, elsewhere its slope is zero. The sums are some 1e2.
      if (there == 0.0) {
        EXPECT_GE(slope[i], -1e-7) << seed;
      } else {
        EXPECT_NEAR(slope[i], 0.0, 1e-7) << seed;
      }
    }
  }
}

}  // namespace
}  // namespace elastocal
