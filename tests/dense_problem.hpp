// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/optim/least_squares.hpp"

namespace elastocal {

/// All residuals of a problem as one vector, block after block.
inline Eigen::VectorXd AllResiduals(LeastSquaresProblem& problem, const Eigen::VectorXd& x) {
  problem.Evaluate(x, false);
  std::vector<double> all;
  for (std::size_t i = 0; i < problem.residual_blocks.size(); ++i) {
    const Eigen::VectorXd& r = problem.Residual(static_cast<int>(i));
    all.insert(all.end(), r.begin(), r.end());
  }
  return Eigen::Map<Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

/// Derivatives of all residuals with respect to all of x.
inline Eigen::MatrixXd DenseJacobian(LeastSquaresProblem& problem, const Eigen::VectorXd& x) {
  problem.Evaluate(x, true);
  std::vector<int> start = {0};
  for (int size : problem.parameter_blocks) start.push_back(start.back() + size);
  int rows = 0;
  for (const auto& block : problem.residual_blocks) rows += block.size;
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(rows, x.size());
  int row = 0;
  for (std::size_t i = 0; i < problem.residual_blocks.size(); ++i) {
    const auto& shape = problem.residual_blocks[i];
    const auto& part = problem.Jacobian(static_cast<int>(i));
    Eigen::Index at = 0;
    for (int block : shape.parameter_blocks) {
      const int width = problem.parameter_blocks[block];
      J.block(row, start[block], shape.size, width) = part.middleCols(at, width);
      at += width;
    }
    row += shape.size;
  }
  return J;
}

/// The same derivatives by central differences.
inline Eigen::MatrixXd DifferenceJacobian(LeastSquaresProblem& problem, const Eigen::VectorXd& x,
                                          double step) {
  Eigen::MatrixXd J;
  for (Eigen::Index u = 0; u < x.size(); ++u) {
    const Eigen::VectorXd aside = step * Eigen::VectorXd::Unit(x.size(), u);
    const Eigen::VectorXd ahead = AllResiduals(problem, x + aside);
    const Eigen::VectorXd behind = AllResiduals(problem, x - aside);
    if (u == 0) J.resize(ahead.size(), x.size());
    J.col(u) = (ahead - behind) / (2.0 * step);
  }
  return J;
}

}  // namespace elastocal
