// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/rotation_vector.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

TEST(RotationVector, QuarterTurnAboutZ) {
  const Eigen::Matrix3d R = RotationFromVector({0.0, 0.0, M_PI / 2.0});
  EXPECT_LT((R * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-15);
  EXPECT_LT((RotationVector(R) - Eigen::Vector3d(0.0, 0.0, M_PI / 2.0)).norm(), 1e-15);
}

TEST(RotationVector, ThereAndBackAtAllSizes) {
  Random random(1);
  for (double size : {0.0, 1e-9, 1e-5, 1e-3, 0.5, 3.0}) {
    const Eigen::Vector3d v = size * random.NormalVector(3, 1.0).normalized();
    EXPECT_LT((RotationVector(RotationFromVector(v)) - v).norm(), 1e-14) << size;
  }
}

TEST(LeftJacobian, IsTheDerivativeAndHasAnInverse) {
  Random random(2);
  for (double size : {0.0, 1e-6, 0.99e-4, 1.01e-4, 0.02, 1.5}) {
    const Eigen::Vector3d v = size * random.NormalVector(3, 1.0).normalized();
    const Eigen::Matrix3d L = LeftJacobian(v);
    EXPECT_LT((L * InverseLeftJacobian(v) - Eigen::Matrix3d::Identity()).norm(), 1e-12) << size;
    constexpr double kStep = 1e-6;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(i);
      const Eigen::Vector3d difference =
          RotationVector(RotationFromVector(v + step) * RotationFromVector(v - step).transpose()) /
          (2.0 * kStep);
      EXPECT_LT((difference - L.col(i)).norm(), 1e-8) << size;
    }
  }
}

}  // namespace
}  // namespace elastocal
