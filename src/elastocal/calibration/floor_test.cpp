// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/floor.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/math/transform.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

TEST(Floor, FlatSolesLeaveNothing) {
  const Eigen::Vector3d up(0.0, 0.6, 0.8), up_foot = Eigen::Vector3d::UnitX();
  Transform T = Transform::Identity();
  T.linear() = RotationBetween(up_foot, up);
  T.translation() = 2.0 * up.unitOrthogonal();  // elsewhere on the floor
  const FloorResidual at = EvaluateFloor(T, Transform::Identity(), up, up_foot);
  EXPECT_LT(at.residual.norm(), 1e-15);
}

TEST(Floor, ResidualIsSlopeAndHeight) {
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  Transform T = Transform::Identity();
  T.linear() = RotationFromVector(Eigen::Vector3d(0.003, 0.004, 0.5));
  T.translation() = Eigen::Vector3d(0.3, 0.1, 0.002);
  const FloorResidual at = EvaluateFloor(T, Transform::Identity(), z, z);
  EXPECT_NEAR(at.residual.head<2>().norm(), 0.005, 1e-4);
  EXPECT_DOUBLE_EQ(at.residual[2], 0.002);
}

TEST(Floor, DerivativesAreThoseOfDifferences) {
  const Eigen::Vector3d up = Eigen::Vector3d(0.1, -0.2, 1.0).normalized();
  const Eigen::Vector3d up_foot = Eigen::Vector3d(0.3, 0.9, 0.2).normalized();
  Transform T = Transform::Identity(), first = Transform::Identity();
  T.linear() = RotationFromVector(Eigen::Vector3d(0.4, -0.3, 0.8));
  T.translation() = Eigen::Vector3d(0.3, 0.1, 0.2);
  first.linear() = RotationFromVector(Eigen::Vector3d(-0.2, 0.5, 0.1));
  const FloorResidual at = EvaluateFloor(T, first, up, up_foot);
  constexpr double kStep = 1e-6;
  const auto moved = [](Transform pose, int k, double step) {
    Eigen::Matrix<double, 6, 1> d = Eigen::Matrix<double, 6, 1>::Zero();
    d[k] = step;
    pose.translation() += pose.linear() * d.head<3>();
    pose.linear() = pose.linear() * RotationFromVector(d.tail<3>());
    return pose;
  };
  for (int k = 0; k < 6; ++k) {
    const Eigen::Vector3d by_foot =
        (EvaluateFloor(moved(T, k, kStep), first, up, up_foot).residual -
         EvaluateFloor(moved(T, k, -kStep), first, up, up_foot).residual) /
        (2.0 * kStep);
    EXPECT_LT((by_foot - at.by_foot.col(k)).norm(), 1e-8) << k;
    const double by_first = (EvaluateFloor(T, moved(first, k, kStep), up, up_foot).residual[2] -
                             EvaluateFloor(T, moved(first, k, -kStep), up, up_foot).residual[2]) /
                            (2.0 * kStep);
    EXPECT_NEAR(by_first, at.height_by_first[k], 1e-8) << k;
  }
}

TEST(Floor, StepsAndRampsAreNotTakenForErrorsOfTheRobot) {
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  Transform T = Transform::Identity();
  T.translation().z() = 0.015;
  T.linear() = RotationFromVector(Eigen::Vector3d(0.1, 0.0, 0.0));
  FloorUse use = UseOfFloor(EvaluateFloor(T, Transform::Identity(), z, z));
  EXPECT_TRUE(use.tilt && use.height);
  T.translation().z() = 0.025;
  T.linear() = RotationFromVector(Eigen::Vector3d(0.2, 0.0, 0.0));
  use = UseOfFloor(EvaluateFloor(T, Transform::Identity(), z, z));
  EXPECT_FALSE(use.tilt || use.height);
}

}  // namespace
}  // namespace elastocal
