// SPDX-License-Identifier: Apache-2.0
#include "elastocal/optim/bounded_step.hpp"

#include <algorithm>
#include <cstddef>

#include "elastocal/math/dense.hpp"

namespace elastocal {
namespace {

constexpr int kMostActiveSets = 20;
constexpr double kSlightGradient = 1e-9;  // a gradient below this leaves an entry at its bound

Eigen::VectorXi NotHeld(const std::vector<char>& held) {
  Eigen::VectorXi free(static_cast<Eigen::Index>(std::count(held.begin(), held.end(), 0)));
  Eigen::Index count = 0;
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (held[i] == 0) free[count++] = static_cast<int>(i);
  }
  return free;
}

/// The step that minimises g'd + d'Hd/2 with the entries `held` at the bound.
Eigen::VectorXd StepBeside(const std::vector<char>& held, const Eigen::MatrixXd& information,
                           const Eigen::VectorXd& gradient, const Eigen::VectorXd& x) {
  const Eigen::VectorXi free = NotHeld(held);
  Eigen::VectorXd step = -x;
  step(free).setZero();
  const Eigen::VectorXd slope = gradient + information * step;
  const Eigen::MatrixXd own = information(free, free);
  step(free) = -SolvePositive(own, slope(free));
  return step;
}

/// Active-set method of Lawson and Hanson (1974, chapter 23) from any set of held entries. It goes
/// towards the best step as far as the first bound, which is then held; at the best step, it lets
/// go the entry whose release lowers the cost most steeply. The cost falls with each change.
Eigen::VectorXd DescendToBoundedStep(std::vector<char> held, const Eigen::MatrixXd& information,
                                     const Eigen::VectorXd& gradient, const Eigen::VectorXd& x,
                                     const std::vector<int>& nonnegative) {
  const std::size_t most_rounds = 10 * nonnegative.size();
  Eigen::VectorXd step = Eigen::VectorXd::Zero(x.size());
  for (int i : nonnegative) step[i] = held[i] ? -x[i] : 0.0;
  for (std::size_t round = 0; round < most_rounds; ++round) {
    const Eigen::VectorXd best = StepBeside(held, information, gradient, x);
    double share = 1.0;
    int first = -1;
    for (int i : nonnegative) {
      if (held[i] || x[i] + best[i] >= 0.0) continue;
      const double until = (x[i] + step[i]) / (step[i] - best[i]);
      if (first >= 0 && until >= share) continue;
      share = until;
      first = i;
    }
    step += share * (best - step);
    if (first >= 0) {
      held[first] = 1;
      step[first] = -x[first];
      continue;
    }
    const Eigen::VectorXd slope = gradient + information * step;
    for (int i : nonnegative) {
      const double steepest = first < 0 ? -kSlightGradient : slope[first];
      if (held[i] && slope[i] < steepest) first = i;
    }
    if (first < 0) break;
    held[first] = 0;
  }
  return step;
}

}  // namespace

Eigen::VectorXd BoundedStep(const Eigen::MatrixXd& information, const Eigen::VectorXd& gradient,
                            const Eigen::VectorXd& x, const std::vector<int>& nonnegative) {
  std::vector<char> held(static_cast<std::size_t>(x.size()), 0);
  for (int i : nonnegative) held[i] = x[i] <= 0.0 && gradient[i] >= 0.0;
  Eigen::VectorXd step;
  // First many entries are held or let go at once. This mostly ends soon, but may run in circles.
  bool changed = true;
  for (int round = 0; round < kMostActiveSets && changed; ++round) {
    changed = false;
    step = StepBeside(held, information, gradient, x);
    for (int i : nonnegative) {
      if (held[i] || x[i] + step[i] >= 0.0) continue;
      held[i] = 1;
      changed = true;
    }
    if (changed) continue;
    const Eigen::VectorXd left = gradient + information * step;
    for (int i : nonnegative) {
      if (!held[i] || left[i] >= -kSlightGradient) continue;
      held[i] = 0;
      changed = true;
    }
  }
  if (changed) step = DescendToBoundedStep(held, information, gradient, x, nonnegative);
  for (int i : nonnegative) step[i] = std::max(step[i], -x[i]);
  return step;
}

}  // namespace elastocal
