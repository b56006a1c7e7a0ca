// SPDX-License-Identifier: Apache-2.0
#include "elastocal/nlp/quasi_newton.hpp"

namespace elastocal {

void QuasiNewtonHessian::Update(const Eigen::VectorXd& step, const Eigen::VectorXd& change) {
  constexpr double kLeastCurvature = 0.2;  // share of the expected curvature (Powell's damping)
  const double length = step.squaredNorm();
  if (!(length > 0.0)) return;
  if (!scaled_ && step.dot(change) > 0.0) {
    hessian_ *= change.squaredNorm() / step.dot(change);
    scaled_ = true;
  }
  const Eigen::VectorXd expected = hessian_ * step;
  const double expected_curvature = step.dot(expected);
  const double curvature = step.dot(change);
  Eigen::VectorXd damped = change;
  if (curvature < kLeastCurvature * expected_curvature) {
    const double share =
        (1.0 - kLeastCurvature) * expected_curvature / (expected_curvature - curvature);
    damped = share * change + (1.0 - share) * expected;
  }
  hessian_ += damped * damped.transpose() / step.dot(damped) -
              expected * expected.transpose() / expected_curvature;
}

}  // namespace elastocal
