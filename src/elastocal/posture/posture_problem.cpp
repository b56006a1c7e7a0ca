// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/posture_problem.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "elastocal/math/interruption.hpp"

namespace elastocal {

Eigen::MatrixXd EvaluateRegressor(PostureProblem& problem, const Eigen::VectorXd& x) {
  InterruptionPoint();
  if (!problem.visible) return problem.regressor.Evaluate(problem.feasible.chain, x);
  problem.feasible.chain.Move(x);
  const std::vector<char> visible = problem.visible(problem.feasible.chain);
  Eigen::VectorXd shown(problem.regressor.rows());
  for (std::size_t m = 0; m < visible.size(); ++m) {
    shown.segment<3>(3 * static_cast<Eigen::Index>(m)).setConstant(visible[m] != 0 ? 1.0 : 0.0);
  }
  return problem.regressor.Evaluate(problem.feasible.chain, x, shown);
}

namespace {

/// information += sign * psi^T psi
void Update(const Eigen::MatrixXd& psi, double sign, Eigen::MatrixXd& information) {
  information.selfadjointView<Eigen::Lower>().rankUpdate(psi.transpose(), sign);
  information.triangularView<Eigen::StrictlyUpper>() = information.transpose();
}

}  // namespace

Eigen::MatrixXd PostureSet::InformationWithout(const std::vector<int>& left_out) const {
  Eigen::MatrixXd information = information_;
  if (static_cast<int>(left_out.size()) == size()) return information.setZero();
  for (int k : left_out) {
    information.selfadjointView<Eigen::Lower>().rankUpdate(psi_[k].transpose(), -1.0);
  }
  information.triangularView<Eigen::StrictlyUpper>() = information.transpose();
  return information;
}

void PostureSet::Add(PostureProblem& problem, const Eigen::VectorXd& x) {
  postures_.push_back(x);
  psi_.push_back(EvaluateRegressor(problem, x));
  Update(psi_.back(), 1.0, information_);
}

void PostureSet::Replace(PostureProblem& problem, int k, const Eigen::VectorXd& x) {
  Update(psi_[k], -1.0, information_);
  postures_[k] = x;
  psi_[k] = EvaluateRegressor(problem, x);
  Update(psi_[k], 1.0, information_);
}

void PostureSet::Remove(int k) {
  Update(psi_[k], -1.0, information_);
  postures_.erase(postures_.begin() + k);
  psi_.erase(psi_.begin() + k);
}

double PostureSet::Index(Criterion criterion) const {
  if (size() == 0) return 0.0;
  return std::exp(EvaluateCriterion(criterion, information_, size()).log_index);
}

PostureSet MakePostureSet(PostureProblem& problem, const std::vector<Eigen::VectorXd>& postures) {
  PostureSet set(problem.column_count());
  for (const Eigen::VectorXd& x : postures) set.Add(problem, x);
  return set;
}

Eigen::VectorXd IndicesWithoutEach(const PostureSet& set, Criterion criterion) {
  Eigen::VectorXd indices = Eigen::VectorXd::Zero(set.size());
  const double log_det = LogDet(set.information());
  if (set.size() < 2 || !std::isfinite(log_det)) return indices;
  const Eigen::LLT<Eigen::MatrixXd> factor(set.information());
  for (int k = 0; k < set.size(); ++k) {
    if (criterion != Criterion::kO1) {
      indices[k] = std::exp(
          EvaluateCriterion(criterion, set.InformationWithout({k}), set.size() - 1).log_index);
      continue;
    }
    // det(M - Psi^T Psi) = det(M) det(I - Psi M^-1 Psi^T)
    const Eigen::MatrixXd half = factor.matrixL().solve(set.psi(k).transpose());
    Eigen::MatrixXd left = -half.transpose() * half;
    left.diagonal().array() += 1.0;
    const double change = LogDet(left);
    indices[k] =
        std::isfinite(change)
            ? O1(log_det + change, static_cast<int>(set.information().cols()), set.size() - 1)
            : 0.0;
  }
  return indices;
}

}  // namespace elastocal
