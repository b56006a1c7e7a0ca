#include "elastocal/math/rotation_vector.hpp"

#include <cmath>

#include "elastocal/math/transform.hpp"

namespace elastocal {
namespace {

/// Below this angle series are used. Their first neglected terms are below 1e-16.
constexpr double kSmallAngle = 1e-2;

/// sin(x) / x, (1 - cos(x)) / x^2 and (x - sin(x)) / x^3.
struct Coefficients {
  double a, b, c;
};

Coefficients MakeCoefficients(double angle) {
  const double square = angle * angle;
  if (angle < kSmallAngle) {
    const double fourth = square * square;
    return {1.0 - square / 6.0 + fourth / 120.0 - square * fourth / 5040.0,
            0.5 - square / 24.0 + fourth / 720.0, 1.0 / 6.0 - square / 120.0 + fourth / 5040.0};
  }
  const double sine = std::sin(angle);
  const double half = std::sin(0.5 * angle);
  return {sine / angle, 2.0 * half * half / square, (angle - sine) / (square * angle)};
}

}  // namespace

Eigen::Matrix3d RotationExp(const Eigen::Vector3d& phi) {
  const Coefficients k = MakeCoefficients(phi.norm());
  const Eigen::Matrix3d S = Skew(phi);
  return Eigen::Matrix3d::Identity() + k.a * S + k.b * S * S;
}

Eigen::Matrix3d RotationExpJacobian(const Eigen::Vector3d& phi) {
  const Coefficients k = MakeCoefficients(phi.norm());
  const Eigen::Matrix3d S = Skew(phi);
  return Eigen::Matrix3d::Identity() + k.b * S + k.c * S * S;
}

}  // namespace elastocal
