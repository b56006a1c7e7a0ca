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

constexpr double kFirstDamping = 1e-4;  // share of the diagonal, after the first failed step
constexpr double kLeastDamping = 1e-9;  // smaller values count as no damping
constexpr double kMostDamping = 1e12;   // beyond this, no step lowers the cost
constexpr double kFasterDamping = 10.0;
constexpr double kPoorGain = 0.25;  // share of the expected decrease: the step is too long
constexpr double kMostLoss = 1.0;   // share of it; after a larger rise no parabola is trusted

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

/// Takes a step from `x`, evaluates `problem` there, and returns the new point with its `cost`. If
/// the cost falls by much less than expected, the curvature along the step is not that of the
/// linearised problem (it may be twice that, and full steps then jump to and fro across the
/// minimum). The step then ends at the minimum of the parabola through the known costs and slope,
/// if the cost is lower there.
Eigen::VectorXd TakeStep(LeastSquaresProblem& problem, const Eigen::VectorXd& x, double cost_before,
                         const Eigen::VectorXd& step, double slope, double expected, double& cost) {
  const Eigen::VectorXd full = x + step;
  problem.Evaluate(full, true);
  cost = CostOf(problem);
  const double gain = (cost_before - cost) / expected;
  if (!(gain < kPoorGain && gain > -kMostLoss)) return full;
  const double share = 0.5 * slope / (cost - cost_before + slope);
  const Eigen::VectorXd part = x + share * step;
  problem.Evaluate(part, true);
  const double cost_there = CostOf(problem);
  if (cost_there < cost) {
    cost = cost_there;
    return part;
  }
  problem.Evaluate(full, true);
  return full;
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
      const double along = -equations.gradient().dot(step);
      const double expected =
          along - 0.5 * step.dot(equations.information() * step) + equations.NuisanceDecrease();
      if (!(expected >
            options.function_tolerance * result.final_cost + std::numeric_limits<double>::min())) {
        End(Termination::kConverged, "no step lowers the cost any more", result);
        return result;
      }
      ++result.iterations;
      InterruptionPoint();
      double cost = 0.0;
      const Eigen::VectorXd next =
          TakeStep(problem, result.x, result.final_cost, equations.Expand(step),
                   along + 2.0 * equations.NuisanceDecrease(), expected, cost);
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
