// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/transform.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// A handful of roundings of numbers near 1.
constexpr double kTransformRounding = 1e-15;
constexpr double kHalfPi = M_PI / 2.0;

Matrix3d FromRpy(const Vector3d& rpy) { return FromXyzRpy(Vector3d::Zero(), rpy).linear(); }

/// Largest entry of the difference between R and the rotation of its angles near `near`.
double RoundTripError(const Matrix3d& R, const Vector3d& near) {
  return (FromRpy(ToRpy(R, near)) - R).cwiseAbs().maxCoeff();
}

TEST(Transform, ElementaryRotationsTurnTheNextAxisTowardsTheOneAfter) {
  EXPECT_LT((RotX(kHalfPi) * Vector3d::UnitY() - Vector3d::UnitZ()).norm(), kTransformRounding);
  EXPECT_LT((RotY(kHalfPi) * Vector3d::UnitZ() - Vector3d::UnitX()).norm(), kTransformRounding);
  EXPECT_LT((RotZ(kHalfPi) * Vector3d::UnitX() - Vector3d::UnitY()).norm(), kTransformRounding);
}

TEST(Transform, RotationAboutTheDiagonalPermutesTheAxes) {
  const Transform T = RotAxis(Vector3d::Ones().normalized(), 2.0 * M_PI / 3.0);
  EXPECT_LT((T * Vector3d(1, 2, 3) - Vector3d(3, 1, 2)).norm(), 4 * kTransformRounding);
}

TEST(Transform, TranslationsAreAlongTheTurnedAxes) {
  EXPECT_EQ(TrX(2.0) * Vector3d(1, 1, 1), Vector3d(3, 1, 1));
  EXPECT_EQ(TrZ(2.0) * Vector3d(1, 1, 1), Vector3d(1, 1, 3));
  EXPECT_LT((RotZ(kHalfPi) * TrX(2.0) * Vector3d::Zero() - Vector3d(0, 2, 0)).norm(),
            kTransformRounding);
}

TEST(Transform, UrdfOriginTurnsAboutFixedAxesRollFirst) {
  // Roll turns y to z, which yaw keeps. Roll keeps x, which yaw turns to y.
  const Transform T = FromXyzRpy({10, 20, 30}, {kHalfPi, 0, kHalfPi});
  EXPECT_LT((T * Vector3d::UnitY() - Vector3d(10, 20, 31)).norm(), 40 * kTransformRounding);
  EXPECT_LT((T * Vector3d::UnitX() - Vector3d(10, 21, 30)).norm(), 40 * kTransformRounding);
}

TEST(Transform, SkewIsTheCrossProduct) {
  const Vector3d v(1, 2, 3), w(-4, 5, 7);
  EXPECT_EQ(Skew(v) * w, v.cross(w));
}

TEST(ToRpy, ReturnsTheAnglesThatARotationWasMadeOf) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    // The angles go beyond one turn and to both sides of pitch = +-90 degrees: `near` selects one
    // of all representations. The angles amplify rounding by 1 / cos(pitch).
    Vector3d rpy;
    for (double& angle : rpy) angle = random.Uniform(-7.0, 7.0);
    const double amplification = 1.0 / std::abs(std::cos(rpy.y()));
    const Vector3d near = rpy + Vector3d(0.1, -0.1, 0.1);
    if (amplification > 5.0) continue;  // the other representation may be nearer
    EXPECT_LT((ToRpy(FromRpy(rpy), near) - rpy).norm(), 20 * kTransformRounding * amplification)
        << rpy.transpose();
  }
}

TEST(ToRpy, TakesTheNearerOfTheTwoRepresentations) {
  const Vector3d rpy(0.2, 0.3, 0.4);
  const Vector3d other(0.2 + M_PI, M_PI - 0.3, 0.4 + M_PI);
  EXPECT_LT((ToRpy(FromRpy(rpy), Vector3d::Zero()) - rpy).norm(), 4 * kTransformRounding);
  EXPECT_LT((ToRpy(FromRpy(rpy), Vector3d(3, 3, 3)) - other).norm(), 8 * kTransformRounding);
  EXPECT_LT((ToRpy(FromRpy(rpy), Vector3d(0, 0, 6)) - rpy - Vector3d(0, 0, 2.0 * M_PI)).norm(),
            8 * kTransformRounding);
}

TEST(ToRpy, KeepsRollAndPitchAndYawOfAGivenOriginAtTheSingularity) {
  // A URDF may hold such angles. The corrected origin must not turn roll into yaw.
  for (double pitch : {kHalfPi, -kHalfPi}) {
    const Vector3d rpy(0.7, pitch, -0.4);
    EXPECT_LT((ToRpy(FromRpy(rpy), rpy) - rpy).norm(), 4 * kTransformRounding);
  }
}

TEST(ToRpy, RoundTripNearTheSingularity) {
  // A calibrated URDF is checked to 1e-9, however near the singularity and for any wanted roll.
  for (double side : {1.0, -1.0}) {
    for (double distance : {0.0, 1e-16, 1e-14, 1e-12, 1e-10, 1e-9, 1e-8, 1e-4}) {
      const Matrix3d R = FromRpy({0.7, side * (kHalfPi - distance), -0.4});
      for (double roll : {0.0, 0.7, 3.0}) {
        EXPECT_LT(RoundTripError(R, {roll, side * kHalfPi, 0.0}), 1e-11) << distance;
      }
    }
  }
}

TEST(RotationBetween, TurnsOneDirectionIntoTheOtherByTheLeastAngle) {
  const Vector3d from(1, -2, 3);
  for (const Vector3d& to : {Vector3d(0.2, 0.1, -0.5), Vector3d(2, -4, 6), Vector3d(-1, 2, -3),
                             Vector3d(-1, 2, -3.001)}) {
    const Matrix3d R = RotationBetween(from, to);
    EXPECT_LT((R * from.normalized() - to.normalized()).norm(), 1e-9);
    EXPECT_LT((R * R.transpose() - Matrix3d::Identity()).norm(), 1e-14);
    EXPECT_NEAR(R.determinant(), 1.0, 1e-14);
    EXPECT_NEAR(std::cos(RotationAngle(R)), from.normalized().dot(to.normalized()), 1e-12);
  }
}

TEST(FitRigid, FindsTheTransformOfPoints) {
  Eigen::Matrix3Xd from(3, 4);
  from << 0, 1, 0, 0.3, 0, 0, 1, -0.2, 0, 0, 0, 0.7;
  const Transform T = FromXyzRpy({1, 2, 3}, {0.4, -0.2, 2.0});
  EXPECT_LT((FitRigid(from, T * from).matrix() - T.matrix()).norm(), 1e-14);
}

TEST(RotationAngle, IsExactAtBothEnds) {
  const Vector3d axis = Vector3d(1, -2, 3).normalized();
  for (double angle : {0.0, 1e-12, 1e-9, 1e-6, 0.5, kHalfPi, 3.0, M_PI - 1e-9}) {
    EXPECT_NEAR(RotationAngle(RotAxis(axis, angle).linear()), angle, 2 * kTransformRounding)
        << angle;
    EXPECT_NEAR(RotationAngle(RotAxis(axis, -angle).linear()), angle, 2 * kTransformRounding)
        << angle;
  }
  // Small angles have relative precision as well.
  EXPECT_NEAR(RotationAngle(RotZ(1e-12).linear()), 1e-12, 1e-24);
  EXPECT_NEAR(RotationAngle(RotX(M_PI).linear()), M_PI, kTransformRounding);
}

}  // namespace
}  // namespace elastocal
