#include "elastocal/math/rotation_vector.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/math/transform.hpp"

namespace elastocal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// On both sides of the angle where series end, and of any size.
constexpr double kAngles[] = {0.0, 1e-9, 1e-4, 0.00999, 0.01001, 0.5, 2.0, 3.1, 6.0};

TEST(RotationVector, IsTheRotationAboutItsDirection) {
  const Vector3d axis = Vector3d(1, -2, 3).normalized();
  for (double angle : kAngles) {
    const Matrix3d R = RotationExp(angle * axis);
    EXPECT_LT((R - RotAxis(axis, angle).linear()).norm(), 2e-15) << angle;
  }
  // A quarter of a turn about z takes x to y.
  EXPECT_LT((RotationExp({0, 0, M_PI / 2}) * Vector3d::UnitX() - Vector3d::UnitY()).norm(), 1e-15);
}

TEST(RotationVector, JacobianIsTheRotationThatAChangeAdds) {
  // Central differences: the step's square 1e-10 and rounding 1e-16 over the step.
  const double step = 1e-5;
  for (double angle : kAngles) {
    const Vector3d phi = angle * Vector3d(2, 1, -2) / 3.0;
    const Matrix3d R = RotationExp(phi);
    for (int i = 0; i < 3; ++i) {
      const Vector3d e = step * Vector3d::Unit(i);
      const Matrix3d slope = (RotationExp(phi + e) - RotationExp(phi - e)) / (2.0 * step);
      const Matrix3d expected = Skew(RotationExpJacobian(phi).col(i));
      EXPECT_LT((slope * R.transpose() - expected).norm(), 2e-10) << angle << ", " << i;
    }
  }
}

}  // namespace
}  // namespace elastocal
