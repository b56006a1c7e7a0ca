// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/random_posture.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "elastocal/math/rotation_vector.hpp"

namespace elastocal {
namespace {

constexpr double kDamping = 1e-4;
constexpr double kTurnWeight = 0.3;  // m/rad: weight of an error of orientation
constexpr double kClearly = 1e-3;    // margin of repaired postures to their limits
constexpr int kPlaceIterations = 20;
constexpr int kRepairIterations = 10;

Eigen::Matrix3d RandomTurn(double largest, Random& random) {
  Eigen::Vector3d axis;
  do {
    for (int i = 0; i < 3; ++i) axis[i] = random.Normal(1.0);
  } while (axis.norm() < 1e-6);
  return Eigen::AngleAxisd(random.Uniform(0.0, largest), axis.normalized()).toRotationMatrix();
}

/// Damped least-squares step, for which J step is nearly `wanted`.
Eigen::VectorXd DampedStep(const Eigen::MatrixXd& J, const Eigen::VectorXd& wanted) {
  Eigen::MatrixXd normal = J.transpose() * J;
  normal.diagonal().array() += kDamping;
  return normal.ldlt().solve(J.transpose() * wanted);
}

}  // namespace

Eigen::VectorXd FeasibleSampler::DrawStart() {
  Eigen::VectorXd x(set_.variable_count());
  for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = random_.Uniform(set_.lower[i], set_.upper[i]);
  return x;
}

std::optional<Eigen::VectorXd> FeasibleSampler::Draw(int most_tries) {
  blame_.clear();
  for (int i = 0; i < most_tries; ++i) {
    ++count_.tries;
    Eigen::VectorXd x = DrawStart();
    if (set_.has_workspace) {
      Eigen::Vector3d p;
      for (int axis = 0; axis < 3; ++axis) {
        p[axis] = random_.Uniform(set_.workspace.lower[axis], set_.workspace.upper[axis]);
      }
      const Eigen::Matrix3d turn = RandomTurn(set_.workspace.largest_turn, random_);
      PlaceEnd(p, turn * set_.workspace.R_root_end, x);
    }
    Violation violation = WorstViolation(set_, x);
    if (violation.amount == 0.0) {
      ++count_.feasible_at_once;
    } else {
      Repair(x);
      violation = WorstViolation(set_, x);
    }
    if (violation.amount == 0.0) {
      ++count_.found;
      return x;
    }
    ++blame_[violation.what];
  }
  return std::nullopt;
}

std::string FeasibleSampler::Blame() const {
  const auto most =
      std::max_element(blame_.begin(), blame_.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == blame_.end() ? "" : most->first;
}

void FeasibleSampler::PlaceEnd(const Eigen::Vector3d& p, const Eigen::Matrix3d& R,
                               Eigen::VectorXd& x) {
  constexpr double kNear = 1e-6;
  for (int i = 0; i < kPlaceIterations; ++i) {
    set_.chain.Move(x);
    const Transform& T = set_.chain.link_poses()[set_.end_link];
    Eigen::VectorXd error(6);
    error.head<3>() = p - T.translation();
    error.tail<3>() = kTurnWeight * RotationVector(R * T.linear().transpose());
    if (error.norm() < kNear) return;
    Eigen::MatrixXd J(6, x.size());
    J.topRows<3>() = set_.chain.PointJacobian(set_.end_link, T.translation());
    J.bottomRows<3>() = kTurnWeight * set_.chain.RotationJacobian(set_.end_link);
    x = (x + DampedStep(J, error)).cwiseMax(set_.lower).cwiseMin(set_.upper);
  }
}

void FeasibleSampler::Repair(Eigen::VectorXd& x) {
  const Eigen::Index moved = std::min<Eigen::Index>(set_.repair_joints, x.size());
  const Eigen::VectorXd lower = set_.ConstraintLower();
  const Eigen::VectorXd upper = set_.ConstraintUpper();
  Eigen::VectorXd values;
  Eigen::MatrixXd jacobian;
  for (int i = 0; i < kRepairIterations; ++i) {
    EvaluateConstraints(set_, x, values, jacobian);
    std::vector<int> rows;
    std::vector<double> wanted;
    for (int row = 0; row < values.size(); ++row) {
      const double least = lower[row] + kClearly;
      const double most = upper[row] - kClearly;
      if (values[row] >= lower[row] && values[row] <= upper[row]) continue;
      rows.push_back(row);
      wanted.push_back(values[row] < lower[row] ? least - values[row] : most - values[row]);
    }
    if (rows.empty()) return;
    const Eigen::MatrixXd J = jacobian(rows, Eigen::seqN(0, moved));
    const Eigen::Map<const Eigen::VectorXd> step_wanted(wanted.data(),
                                                        static_cast<Eigen::Index>(wanted.size()));
    x.head(moved) = (x.head(moved) + DampedStep(J, step_wanted))
                        .cwiseMax(set_.lower.head(moved))
                        .cwiseMin(set_.upper.head(moved));
  }
}

}  // namespace elastocal
