// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace elastocal {

/// A dense, positive definite approximation of a Lagrangian's Hessian from its gradients (BFGS with
/// Powell's damping: Nocedal and Wright, Numerical Optimization, procedure 18.2). Made for some ten
/// variables.
class QuasiNewtonHessian {
 public:
  explicit QuasiNewtonHessian(Eigen::Index size)
      : hessian_(Eigen::MatrixXd::Identity(size, size)) {}

  /// Updates the approximation by a step and by the change of the gradient along it.
  void Update(const Eigen::VectorXd& step, const Eigen::VectorXd& change);

  const Eigen::MatrixXd& hessian() const { return hessian_; }

 private:
  Eigen::MatrixXd hessian_;
  bool scaled_ = false;  // by a first step
};

}  // namespace elastocal
