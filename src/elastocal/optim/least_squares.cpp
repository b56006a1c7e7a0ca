// SPDX-License-Identifier: Apache-2.0
#include "elastocal/optim/least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elastocal/math/interruption.hpp"
#include "elastocal/optim/bounded_step.hpp"
#include "elastocal/optim/normal_equations.hpp"

namespace elastocal {
namespace {

constexpr double kFirstDamping = 1e-4;  // of the diagonal, after the first step that failed
constexpr double kLeastDamping = 1e-9;  // below: none
constexpr double kMostDamping = 1e12;   // no step lowers the cost
constexpr double kFasterDamping = 10.0;

void End(Termination termination, const char* message, LeastSquaresResult& result) {
  result.termination = termination;
  result.message = message;
}

Eigen::VectorXd DampedStep(const NormalEquations& equations, double damping,
                           const Eigen::VectorXd& x, const std::vector<int>& nonnegative) {
  Eigen::MatrixXd information = equations.information();
  information.diagonal() *= 1.0 + damping;
  return BoundedStep(information, equations.gradient(), x(equations.unknowns()), nonnegative);
}

}  // namespace

LeastSquaresResult Solve(LeastSquaresProblem& problem, const Eigen::VectorXd& x0,
                         const LeastSquaresOptions& options) {
  LeastSquaresResult result;
  result.x = x0;
  for (int i : problem.nonnegative) result.x[i] = std::max(0.0, result.x[i]);
  problem.Evaluate(result.x, true);
  result.initial_cost = result.final_cost = CostOf(problem);
  if (!std::isfinite(result.initial_cost)) {
    result.initial_cost = result.final_cost = std::numeric_limits<double>::quiet_NaN();
    End(Termination::kFailure, "the residuals at the start are not finite", result);
    return result;
  }
  double damping = 0.0;
  for (;;) {
    const NormalEquations equations(problem);
    const std::vector<int> bounded = equations.Positions(problem.nonnegative);
    for (;;) {
      if (result.iterations == options.max_iterations) {
        End(Termination::kNoConvergence, "the iterations were used up", result);
        return result;
      }
      const Eigen::VectorXd step = DampedStep(equations, damping, result.x, bounded);
      if (!step.allFinite()) {
        End(Termination::kFailure, "the linearised problem is singular", result);
        return result;
      }
      const double expected = -equations.gradient().dot(step) -
                              0.5 * step.dot(equations.information() * step) +
                              equations.NuisanceDecrease();
      if (!(expected >
            options.function_tolerance * result.final_cost + std::numeric_limits<double>::min())) {
        End(Termination::kConverged, "no step lowers the cost any more", result);
        return result;
      }
      ++result.iterations;
      InterruptionPoint();
      const Eigen::VectorXd next = result.x + equations.Expand(step);
      problem.Evaluate(next, true);
      const double cost = CostOf(problem);
      if (cost <= result.final_cost) {
        result.x = next;
        result.final_cost = cost;
        damping = damping > kLeastDamping ? damping / kFasterDamping : 0.0;
        break;
      }
      damping = std::max(kFirstDamping, kFasterDamping * damping);
      if (damping > kMostDamping) {
        // Rounding keeps the cost from falling as far as expected.
        End(Termination::kConverged, "no step lowers the cost any more", result);
        return result;
      }
    }
  }
}

}  // namespace elastocal
