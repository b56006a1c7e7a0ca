// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/partial_optim.hpp"

#include <algorithm>

#include "elastocal/nlp/nonlinear_program.hpp"

namespace elastocal {
namespace {

/// The log of the index as a function of some postures, which are stacked in x.
class IndexProgram : public NonlinearProgram {
 public:
  IndexProgram(PostureProblem& problem, const std::vector<int>& which, const PostureSet& set)
      : problem_(problem),
        others_(set.InformationWithout(which)),
        postures_(set.size()),
        scale_(problem.column_count()) {
    const int count = static_cast<int>(which.size());
    const int variables = problem.variable_count();
    const int constraints = problem.feasible.constraint_count();
    lower = problem.feasible.lower.replicate(count, 1);
    upper = problem.feasible.upper.replicate(count, 1);
    constraint_lower = problem.feasible.ConstraintLower().replicate(count, 1);
    constraint_upper = problem.feasible.ConstraintUpper().replicate(count, 1);
    constraints_.resize(constraint_lower.size());
    for (int i = 0; i < count; ++i) {
      jacobian_blocks.push_back({i * constraints, constraints, i * variables, variables});
      const Eigen::MatrixXd& psi = set.psi(which[i]);
      shown_.emplace_back((psi.rowwise().squaredNorm().array() > 0.0).cast<double>().matrix());
    }
    jacobian_.resize(count);
    psi_.resize(count);
  }

  bool Evaluate(const Eigen::VectorXd& x) override {
    x_ = x;
    Eigen::MatrixXd information = others_;
    const Eigen::Index constraints = problem_.feasible.constraint_count();
    for (std::size_t i = 0; i < psi_.size(); ++i) {
      psi_[i] = Regressor(i);
      information.selfadjointView<Eigen::Lower>().rankUpdate(psi_[i].transpose());
      EvaluateConstraints(problem_.feasible, Posture(i), values_, jacobian_[i]);
      constraints_.segment(static_cast<Eigen::Index>(i) * constraints, constraints) = values_;
    }
    value_ = EvaluateCriterion(problem_.criterion, information.selfadjointView<Eigen::Lower>(),
                               postures_);
    return value_.defined();
  }

  double Objective() const override { return -scale_ * value_.log_index; }

  Eigen::VectorXd Gradient() override {
    Eigen::VectorXd gradient(x_.size());
    const Eigen::Index variables = problem_.variable_count();
    for (std::size_t i = 0; i < psi_.size(); ++i) {
      const Eigen::MatrixXd weight = -scale_ * psi_[i] * value_.weight;
      Regressor(i);
      gradient.segment(static_cast<Eigen::Index>(i) * variables, variables) =
          problem_.regressor.Gradient(problem_.feasible.chain, weight);
    }
    return gradient;
  }

  const Eigen::VectorXd& Constraints() const override { return constraints_; }
  const std::vector<Eigen::MatrixXd>& Jacobian() const override { return jacobian_; }

  Eigen::VectorXd Posture(std::size_t i) const {
    const Eigen::Index variables = problem_.variable_count();
    return x_.segment(static_cast<Eigen::Index>(i) * variables, variables);
  }
  void MoveTo(const Eigen::VectorXd& x) { x_ = x; }

 private:
  Eigen::MatrixXd Regressor(std::size_t i) {
    return problem_.regressor.Evaluate(problem_.feasible.chain, Posture(i), shown_[i]);
  }

  PostureProblem& problem_;
  Eigen::MatrixXd others_;
  int postures_;
  double scale_;  // the index changes little by one posture among many; log det is of order one
  std::vector<Eigen::VectorXd> shown_;  // for each posture, 1 for rows of markers that are seen
  Eigen::VectorXd x_, values_, constraints_;
  std::vector<Eigen::MatrixXd> psi_, jacobian_;
  CriterionValue value_;
};

}  // namespace

bool PartialOptim(PostureProblem& problem, const std::vector<int>& which, PostureSet& set,
                  const PartialOptimOptions& options) {
  const int variables = problem.variable_count();
  Eigen::VectorXd x0(variables * static_cast<Eigen::Index>(which.size()));
  for (std::size_t i = 0; i < which.size(); ++i) {
    x0.segment(static_cast<Eigen::Index>(i) * variables, variables) = set.posture(which[i]);
  }
  IndexProgram program(problem, which, set);
  NonlinearProgramOptions solver;
  solver.max_iterations = options.max_iterations;
  solver.tolerance = options.tolerance;
  solver.first_barrier = 1e-3;  // postures are feasible already
  const NonlinearProgramResult solved = Solve(program, x0, solver);
  program.MoveTo(solved.x);
  PostureSet moved = set;
  for (std::size_t i = 0; i < which.size(); ++i) {
    const Eigen::VectorXd x = program.Posture(i);
    if (WorstViolation(problem.feasible, x).amount > kFeasible) return false;
    moved.Replace(problem, which[i], x);
  }
  if (!(moved.Index(problem.criterion) > set.Index(problem.criterion))) return false;
  set = std::move(moved);
  return true;
}

}  // namespace elastocal
