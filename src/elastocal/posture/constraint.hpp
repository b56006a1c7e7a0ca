// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <Eigen/Core>

#include "elastocal/robot/moving_chain.hpp"

namespace elastocal {

/// A constraint that feasible postures fulfil (paper section 3.1): lower() <= value <= upper(), row
/// by row. Values are of the order of one: metres, cosines, shares of the largest torque.
class PostureConstraint {
 public:
  virtual ~PostureConstraint() = default;

  /// What the row limits, in words ("torque of leg_left_4_joint").
  virtual std::string Name(int row) const = 0;
  const Eigen::VectorXd& lower() const { return lower_; }
  const Eigen::VectorXd& upper() const { return upper_; }
  int size() const { return static_cast<int>(lower_.size()); }

  /// Computes values, size(), and derivatives, size() x chain.size(), in the posture of `chain`.
  virtual void Evaluate(const MovingChain& chain, Eigen::Ref<Eigen::VectorXd> value,
                        Eigen::Ref<Eigen::MatrixXd> jacobian) const = 0;

 protected:
  void SetRange(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) {
    lower_ = lower;
    upper_ = upper;
  }

 private:
  Eigen::VectorXd lower_, upper_;
};

}  // namespace elastocal
