// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/optim/termination.hpp"

namespace elastocal {

/// A nonlinear least-squares problem in blocks: minimise over x
///
///   1/2 sum_i |f_i(x)|^2
///
/// where the residual block f_i depends on few of the blocks that x is divided into. Shape is fixed
/// at construction; Evaluate is called for every new x, before any Residual or Jacobian.
class LeastSquaresProblem {
 public:
  using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  struct ResidualBlock {
    int size = 0;
    std::vector<int> parameter_blocks;  ///< blocks of x that it depends on, each once
    /// Whether it is part of the sum that is minimised. A block that is not is only evaluated.
    bool active = true;
  };

  virtual ~LeastSquaresProblem() = default;

  /// Sizes of the blocks of x, in order.
  std::vector<int> parameter_blocks;
  std::vector<ResidualBlock> residual_blocks;
  /// Blocks of x that are eliminated first (Schur complement). No two may meet in one residual
  /// block, which lists its own first or last; there must be others besides them.
  std::vector<int> nuisance_blocks;
  /// Entries of x that may not become negative, ascending; none in a nuisance block.
  std::vector<int> nonnegative;

  virtual void Evaluate(const Eigen::VectorXd& x, bool with_jacobians) = 0;
  virtual const Eigen::VectorXd& Residual(int block) const = 0;
  /// Derivatives of a residual block by its parameter blocks, side by side in the order in which it
  /// lists them. Valid after Evaluate with jacobians.
  virtual const RowMajorMatrix& Jacobian(int block) const = 0;
};

struct LeastSquaresOptions {
  int max_iterations = 100;
  /// The solver ends when a step is expected to lower the cost by less than this share of it.
  double function_tolerance = 1e-13;
};

struct LeastSquaresResult {
  Eigen::VectorXd x;                            ///< best point found, whatever the termination
  double initial_cost = 0.0, final_cost = 0.0;  ///< NaN where x0 could not be evaluated
  int iterations = 0;                           ///< steps tried
  Termination termination = Termination::kFailure;
  std::string message;  ///< why it ended, in words
};

/// Levenberg-Marquardt from `x0`: Gauss-Newton steps, each the minimum of the linearised problem
/// under the bounds (BoundedStep), damped only if a step does not lower the cost. On one thread:
/// same input, same bits out.
LeastSquaresResult Solve(LeastSquaresProblem& problem, const Eigen::VectorXd& x0,
                         const LeastSquaresOptions& options = {});

}  // namespace elastocal
