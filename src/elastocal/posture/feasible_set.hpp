#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/posture/constraint.hpp"
#include "elastocal/posture/workspace.hpp"
#include "elastocal/robot/moving_chain.hpp"

namespace elastocal {

/// The postures that a chain may take (paper section 3.1, eq. 8-11): limits of the coordinates and
/// constraints of any sort. A posture x stands for the chain's coordinates, rad or m.
struct FeasibleSet {
  MovingChain chain;
  Eigen::VectorXd lower, upper;  ///< eq. 8
  std::vector<std::unique_ptr<PostureConstraint>> constraints;
  int end_link = 0;  ///< whose pose the random postures are drawn by
  bool has_workspace = false;
  Workspace workspace = {};
  int repair_joints = 3;  ///< coordinates, the first ones, that make room where spheres meet

  int variable_count() const { return chain.size(); }
  int constraint_count() const;
  Eigen::VectorXd ConstraintLower() const;
  Eigen::VectorXd ConstraintUpper() const;
};

/// Values and derivatives (constraint_count() x variables) of all constraints at x.
void EvaluateConstraints(FeasibleSet& set, const Eigen::VectorXd& x, Eigen::VectorXd& values,
                         Eigen::MatrixXd& jacobian);

/// By how much a posture is beyond the limit that it breaks most, 0 where it is feasible, and which
/// limit that is.
struct Violation {
  double amount = 0.0;  ///< rad or m for limits of coordinates, else as PostureConstraint has it
  std::string what;
};
Violation WorstViolation(FeasibleSet& set, const Eigen::VectorXd& x);

inline constexpr double kFeasible = 1e-6;  ///< largest violation of a posture that is called so

}  // namespace elastocal
