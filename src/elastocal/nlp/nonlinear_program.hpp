// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/optim/termination.hpp"

namespace elastocal {

/// A smooth nonlinear programme: minimise f(x) subject to lower <= x <= upper and
/// constraint_lower <= g(x) <= constraint_upper.
class NonlinearProgram {
 public:
  /// A dense block of the Jacobian of g; outside of all blocks it is zero.
  struct Block {
    int row = 0, rows = 0, column = 0, columns = 0;
  };

  virtual ~NonlinearProgram() = default;

  Eigen::VectorXd lower, upper;
  Eigen::VectorXd constraint_lower, constraint_upper;
  std::vector<Block> jacobian_blocks;

  /// Called for every new x before any of the others. Returns whether f and g are defined there; if
  /// not, the solver takes a shorter step.
  virtual bool Evaluate(const Eigen::VectorXd& x) = 0;
  virtual double Objective() const = 0;
  virtual Eigen::VectorXd Gradient() = 0;
  virtual const Eigen::VectorXd& Constraints() const = 0;
  /// Derivatives, one matrix for each block.
  virtual const std::vector<Eigen::MatrixXd>& Jacobian() const = 0;
};

struct NonlinearProgramOptions {
  int max_iterations = 100;
  double tolerance = 1e-6;             ///< of optimality, scaled (Ipopt's `tol`)
  double first_barrier = 0.1;          ///< Ipopt's `mu_init`; smaller if x0 is good already
  double constraint_tolerance = 1e-8;  ///< largest violation of g, in its own units
};

struct NonlinearProgramResult {
  Eigen::VectorXd x;  ///< last point, within lower and upper
  double objective = 0.0;
  int iterations = 0;
  Termination termination = Termination::kFailure;
  std::string message;  ///< the solver's own words
};

/// Solves the programme from `x0` by an interior-point method (Ipopt, Wachter and Biegler 2006)
/// with a dense quasi-Newton Hessian. Made for up to some hundred variables. Runs on one thread and
/// must not be called from several at once (MUMPS, its linear solver, is not thread-safe). The same
/// input gives the same bits.
NonlinearProgramResult Solve(NonlinearProgram& program, const Eigen::VectorXd& x0,
                             const NonlinearProgramOptions& options);

}  // namespace elastocal
