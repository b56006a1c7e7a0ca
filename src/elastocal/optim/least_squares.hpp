#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/optim/termination.hpp"

namespace elastocal {

/// A nonlinear least-squares problem in blocks: minimise over x
///
///   1/2 sum_i rho(|f_i(x)|^2)
///
/// where the residual block f_i depends on few of the blocks that x is divided into. Shape is fixed
/// at construction; Evaluate is called once for every new x, before any Residual or Jacobian.
class LeastSquaresProblem {
 public:
  using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  struct ResidualBlock {
    int size = 0;
    std::vector<int> parameter_blocks;  ///< that it depends on, each once
    bool robust = true;                 ///< whether the loss applies to it
    /// Whether it takes part in the minimum; one that does not is only evaluated.
    bool active = true;
  };

  virtual ~LeastSquaresProblem() = default;

  /// Sizes of the blocks of x, in order.
  std::vector<int> parameter_blocks;
  std::vector<ResidualBlock> residual_blocks;
  /// Blocks of x that are eliminated first (Schur complement). No two may meet in one residual
  /// block; there must be others besides them.
  std::vector<int> eliminated_blocks;
  /// Entries of x that may not become negative, ascending.
  std::vector<int> nonnegative;

  virtual void Evaluate(const Eigen::VectorXd& x, bool with_jacobians) = 0;
  virtual void Residual(int block, Eigen::Map<Eigen::VectorXd> residual) const = 0;
  /// Derivative of residual block `block` by the `k`-th of the parameter blocks that it lists.
  virtual void Jacobian(int block, int k, Eigen::Map<RowMajorMatrix> jacobian) const = 0;
};

struct LeastSquaresOptions {
  /// Scale of Cauchy's loss rho(s) = c^2 log(1 + s / c^2) in units of the residuals; 0: rho(s) = s.
  double cauchy_scale = 0.0;
  int max_iterations = 100;
  /// Ends when the cost changes relatively by less than this in a step ...
  double function_tolerance = 1e-12;
  /// ... or when the step is relatively smaller than this.
  double parameter_tolerance = 1e-12;
};

struct LeastSquaresResult {
  Eigen::VectorXd x;                            ///< best point found, whatever the termination
  double initial_cost = 0.0, final_cost = 0.0;  ///< NaN where x0 could not be evaluated
  int iterations = 0;
  Termination termination = Termination::kFailure;
  std::string message;  ///< the solver's own words
};

/// Levenberg-Marquardt (Ceres Solver) from `x0`, on one thread: same input, same bits out.
LeastSquaresResult Solve(LeastSquaresProblem& problem, const Eigen::VectorXd& x0,
                         const LeastSquaresOptions& options);

}  // namespace elastocal
