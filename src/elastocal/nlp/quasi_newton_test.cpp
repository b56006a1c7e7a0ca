// SPDX-License-Identifier: Apache-2.0
#include "elastocal/nlp/quasi_newton.hpp"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

namespace elastocal {
namespace {

TEST(QuasiNewtonHessian, BecomesTheHessianOfAQuadraticAlongConjugateSteps) {
  const Eigen::Matrix3d truth{{4.0, 1.0, 0.0}, {1.0, 3.0, 0.5}, {0.0, 0.5, 2.0}};
  // The steps are conjugate with respect to the true Hessian. After one step per variable, BFGS is
  // exact.
  Eigen::Matrix3d steps = Eigen::Matrix3d::Identity();
  for (int i = 1; i < 3; ++i) {
    for (int j = 0; j < i; ++j) {
      const double share =
          steps.col(j).dot(truth * steps.col(i)) / steps.col(j).dot(truth * steps.col(j));
      steps.col(i) -= share * steps.col(j);
    }
  }
  QuasiNewtonHessian quasi(3);
  for (int i = 0; i < 3; ++i) quasi.Update(steps.col(i), truth * steps.col(i));
  EXPECT_LT((quasi.hessian() - truth).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(QuasiNewtonHessian, StaysPositiveDefiniteWhereTheCurvatureIsNegative) {
  QuasiNewtonHessian quasi(2);
  quasi.Update(Eigen::Vector2d(1.0, 0.0), Eigen::Vector2d(2.0, 0.0));
  quasi.Update(Eigen::Vector2d(0.3, 1.0), Eigen::Vector2d(0.6, -5.0));
  EXPECT_EQ(quasi.hessian().llt().info(), Eigen::Success);
  EXPECT_GT(quasi.hessian()(0, 0), 0.0);
}

TEST(QuasiNewtonHessian, LearnsNothingFromNoStep) {
  QuasiNewtonHessian quasi(2);
  quasi.Update(Eigen::Vector2d::Zero(), Eigen::Vector2d(1.0, 1.0));
  EXPECT_EQ(quasi.hessian(), Eigen::Matrix2d::Identity());
}

}  // namespace
}  // namespace elastocal
