// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/posture/constraint.hpp"
#include "elastocal/posture/workspace.hpp"
#include "elastocal/robot/moving_chain.hpp"

namespace elastocal {

/// The postures that a chain may take (paper section 3.1, eq. 8-11): limits of the coordinates,
/// constraints, and what can be reached. A posture x consists of the chain's coordinates, rad or m.
struct FeasibleSet {
  MovingChain chain;
  Eigen::VectorXd lower, upper;  ///< eq. 8
  std::vector<std::unique_ptr<PostureConstraint>> constraints;
  int end_link = 0;  ///< link by whose pose random postures are drawn
  bool has_workspace = false;
  Workspace workspace = {};
  /// Whether the robot can move from rest to a posture past its own parts. Empty: to any posture.
  std::function<bool(const Eigen::VectorXd& x)> reachable = {};
  int repair_joints = 3;  ///< number of first coordinates that move to separate spheres

  int variable_count() const { return chain.size(); }
  int constraint_count() const;
  Eigen::VectorXd ConstraintLower() const;
  Eigen::VectorXd ConstraintUpper() const;
};

/// Values and derivatives (constraint_count() x variables) of all constraints at x.
void EvaluateConstraints(FeasibleSet& set, const Eigen::VectorXd& x, Eigen::VectorXd& values,
                         Eigen::MatrixXd& jacobian);

/// The limit that a posture breaks most, and by how much; 0 if the posture is feasible. A posture
/// that keeps all limits but cannot be reached has the amount 1.
struct Violation {
  double amount =
      0.0;  ///< rad or m for limits of coordinates, otherwise in units of the PostureConstraint
  std::string what;
  bool unreachable = false;  ///< no limit is broken, but the robot cannot move there

  /// What a posture does, as the end of a sentence: "breaks the limit of arm_1_joint by 0.12".
  std::string Describe() const;
};
/// The worst violation by posture x.
Violation WorstViolation(FeasibleSet& set, const Eigen::VectorXd& x);

inline constexpr double kFeasible = 1e-6;  ///< largest violation of a feasible posture

}  // namespace elastocal
