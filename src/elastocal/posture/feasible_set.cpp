// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/feasible_set.hpp"

#include <iomanip>
#include <sstream>

#include "elastocal/math/interruption.hpp"
#include "elastocal/robot/coordinates.hpp"

namespace elastocal {
namespace {

template <typename Get>
Eigen::VectorXd Stacked(const FeasibleSet& set, const Get& get) {
  Eigen::VectorXd stacked(set.constraint_count());
  Eigen::Index row = 0;
  for (const auto& constraint : set.constraints) {
    stacked.segment(row, constraint->size()) = get(*constraint);
    row += constraint->size();
  }
  return stacked;
}

}  // namespace

int FeasibleSet::constraint_count() const {
  int count = 0;
  for (const auto& constraint : constraints) count += constraint->size();
  return count;
}

Eigen::VectorXd FeasibleSet::ConstraintLower() const {
  return Stacked(*this, [](const PostureConstraint& c) { return c.lower(); });
}

Eigen::VectorXd FeasibleSet::ConstraintUpper() const {
  return Stacked(*this, [](const PostureConstraint& c) { return c.upper(); });
}

void EvaluateConstraints(FeasibleSet& set, const Eigen::VectorXd& x, Eigen::VectorXd& values,
                         Eigen::MatrixXd& jacobian) {
  InterruptionPoint();
  values.resize(set.constraint_count());
  jacobian.resize(set.constraint_count(), set.variable_count());
  set.chain.Move(x);
  Eigen::Index row = 0;
  for (const auto& constraint : set.constraints) {
    const Eigen::Index size = constraint->size();
    constraint->Evaluate(set.chain, values.segment(row, size), jacobian.middleRows(row, size));
    row += size;
  }
}

Violation WorstViolation(FeasibleSet& set, const Eigen::VectorXd& x) {
  Violation worst;
  const auto note = [&](double value, double lower, double upper, const auto& name) {
    const double amount = std::max(lower - value, value - upper);
    if (amount > worst.amount) worst = {.amount = amount, .what = name()};
  };
  const RobotTree& tree = set.chain.tree();
  for (int i = 0; i < set.variable_count(); ++i) {
    note(x[i], set.lower[i], set.upper[i],
         [&] { return "limit of " + JointOfCoordinate(tree, set.chain.coordinates()[i]).name; });
  }
  Eigen::VectorXd values;
  Eigen::MatrixXd jacobian;
  EvaluateConstraints(set, x, values, jacobian);
  Eigen::Index at = 0;
  for (const auto& constraint : set.constraints) {
    for (int row = 0; row < constraint->size(); ++row, ++at) {
      note(values[at], constraint->lower()[row], constraint->upper()[row],
           [&] { return constraint->Name(row); });
    }
  }
  if (worst.amount <= kFeasible && set.reachable && !set.reachable(x)) {
    return {1.0, "way from the posture of rest past the robot's own parts", true};
  }
  return worst;
}

std::string Violation::Describe() const {
  if (unreachable) return "cannot be reached: no " + what + " was found";
  std::ostringstream text;
  text << "breaks the " << what << " by " << std::setprecision(3) << amount;
  return text.str();
}

}  // namespace elastocal
