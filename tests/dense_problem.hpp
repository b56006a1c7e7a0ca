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
    Eigen::VectorXd r(problem.residual_blocks[i].size);
    problem.Residual(static_cast<int>(i), Eigen::Map<Eigen::VectorXd>(r.data(), r.size()));
    all.insert(all.end(), r.begin(), r.end());
  }
  return Eigen::Map<Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

/// Their derivatives by all of x.
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
    for (std::size_t k = 0; k < shape.parameter_blocks.size(); ++k) {
      const int block = shape.parameter_blocks[k];
      LeastSquaresProblem::RowMajorMatrix part(shape.size, problem.parameter_blocks[block]);
      problem.Jacobian(
          static_cast<int>(i), static_cast<int>(k),
          Eigen::Map<LeastSquaresProblem::RowMajorMatrix>(part.data(), part.rows(), part.cols()));
      J.block(row, start[block], part.rows(), part.cols()) = part;
    }
    row += shape.size;
  }
  return J;
}

}  // namespace elastocal
