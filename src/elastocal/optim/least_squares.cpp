#include "elastocal/optim/least_squares.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <set>

#include <ceres/ceres.h>
#include <glog/logging.h>

namespace elastocal {
namespace {

/// Where Levenberg-Marquardt starts: all but undamped, as Gauss-Newton. From Ceres' default of 1e4
/// weakly determined directions crept for as many steps as it took the radius to grow.
constexpr double kInitialTrustRegionRadius = 1e8;

/// Tells the problem of every new point before Ceres asks for residuals. With derivatives at once:
/// most steps are taken, and then they are asked for.
class PointCallback : public ceres::EvaluationCallback {
 public:
  PointCallback(LeastSquaresProblem& problem, const Eigen::VectorXd& x)
      : problem_(problem), x_(x) {}

  void PrepareForEvaluation(bool /*with_jacobians*/, bool new_point) override {
    if (new_point || !evaluated_) problem_.Evaluate(x_, true);
    evaluated_ = true;
  }

 private:
  LeastSquaresProblem& problem_;
  const Eigen::VectorXd& x_;
  bool evaluated_ = false;
};

class BlockCost : public ceres::CostFunction {
 public:
  BlockCost(const LeastSquaresProblem& problem, int block) : problem_(problem), block_(block) {
    const auto& shape = problem.residual_blocks[block];
    set_num_residuals(shape.size);
    for (int k : shape.parameter_blocks) {
      mutable_parameter_block_sizes()->push_back(problem.parameter_blocks[k]);
    }
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    Eigen::Map<Eigen::VectorXd> residual(residuals, num_residuals());
    problem_.Residual(block_, residual);
    if (!residual.allFinite()) return false;
    if (jacobians == nullptr) return true;
    for (std::size_t k = 0; k < parameter_block_sizes().size(); ++k) {
      if (jacobians[k] == nullptr) continue;
      problem_.Jacobian(block_, static_cast<int>(k),
                        Eigen::Map<LeastSquaresProblem::RowMajorMatrix>(
                            jacobians[k], num_residuals(), parameter_block_sizes()[k]));
    }
    return true;
  }

 private:
  const LeastSquaresProblem& problem_;
  int block_;
};

/// The parameter blocks as Ceres addresses them: pointers into one vector.
std::vector<double*> AddParameterBlocks(const LeastSquaresProblem& problem, Eigen::VectorXd& x,
                                        ceres::Problem& ceres_problem) {
  std::vector<double*> blocks;
  double* at = x.data();
  for (int size : problem.parameter_blocks) {
    ceres_problem.AddParameterBlock(at, size);
    blocks.push_back(at);
    at += size;
  }
  return blocks;
}

ceres::Solver::Options SolverOptions(const LeastSquaresProblem& problem,
                                     const std::vector<double*>& blocks,
                                     const LeastSquaresOptions& options) {
  ceres::Solver::Options solver;
  solver.num_threads = 1;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.function_tolerance;
  solver.parameter_tolerance = options.parameter_tolerance;
  solver.gradient_tolerance = 0.0;
  solver.initial_trust_region_radius = kInitialTrustRegionRadius;
  solver.logging_type = ceres::SILENT;
  solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  if (!problem.eliminated_blocks.empty()) {
    solver.linear_solver_type = ceres::DENSE_SCHUR;
    auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (double* block : blocks) ordering->AddElementToGroup(block, 1);
    for (int k : problem.eliminated_blocks) ordering->AddElementToGroup(blocks[k], 0);
    solver.linear_solver_ordering = ordering;
  }
  return solver;
}

/// What Ceres logs of a failure is in its summary as well: a library does not print.
class QuietLog {
 public:
  QuietLog() : before_(FLAGS_minloglevel) { FLAGS_minloglevel = google::GLOG_FATAL; }
  ~QuietLog() { FLAGS_minloglevel = before_; }
  QuietLog(const QuietLog&) = delete;
  QuietLog& operator=(const QuietLog&) = delete;

 private:
  int before_;
};

Termination Translate(ceres::TerminationType type) {
  switch (type) {
    case ceres::CONVERGENCE:
    case ceres::USER_SUCCESS:
      return Termination::kConverged;
    case ceres::NO_CONVERGENCE:
      return Termination::kNoConvergence;
    default:
      return Termination::kFailure;
  }
}

constexpr int kMaxActiveSets = 10;
constexpr double kSlightGradient = 1e-9;  // of the cost by an unknown: no reason to leave a bound

/// Which unknowns stand at their bound of zero. Ceres' own bounds project every step and creep
/// where several of them are active; here those at the bound are held, and the problem is free.
class ActiveSet {
 public:
  ActiveSet(LeastSquaresProblem& problem, const LeastSquaresOptions& options,
            const Eigen::VectorXd& x)
      : problem_(problem), cauchy_scale_(options.cauchy_scale) {
    if (problem.nonnegative.empty()) return;
    const Eigen::VectorXd gradient = Gradient(x);
    for (int i : problem.nonnegative) {
      if (x[i] == 0.0 && gradient[i] >= 0.0) held_.insert(i);
    }
  }

  /// Makes the held unknowns constant, and no others.
  void Hold(const std::vector<double*>& blocks, ceres::Problem& ceres_problem) const {
    if (problem_.nonnegative.empty()) return;
    int begin = 0;
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      const int size = problem_.parameter_blocks[k];
      std::vector<int> constant;
      for (auto i = held_.lower_bound(begin); i != held_.end() && *i < begin + size; ++i) {
        constant.push_back(*i - begin);
      }
      ceres_problem.SetParameterBlockVariable(blocks[k]);
      if (static_cast<int>(constant.size()) == size) {
        ceres_problem.SetParameterBlockConstant(blocks[k]);
      } else {
        ceres_problem.SetManifold(
            blocks[k], constant.empty() ? nullptr : new ceres::SubsetManifold(size, constant));
      }
      begin += size;
    }
  }

  /// Holds what has become negative and, if nothing has, lets go what wants to leave its bound.
  /// Whether the problem has to be solved again.
  bool Update(Eigen::VectorXd& x) {
    bool changed = false;
    for (int i : problem_.nonnegative) {
      if (x[i] >= 0.0) continue;
      x[i] = 0.0;
      held_.insert(i);
      changed = true;
    }
    if (changed || held_.empty()) return changed;
    const Eigen::VectorXd gradient = Gradient(x);
    for (int i : std::set<int>(held_)) {
      if (gradient[i] >= -kSlightGradient || !released_.insert(i).second) continue;
      held_.erase(i);
      changed = true;
    }
    return changed;
  }

 private:
  /// Of the cost, loss included.
  Eigen::VectorXd Gradient(const Eigen::VectorXd& x) const {
    problem_.Evaluate(x, true);
    std::vector<int> first(1, 0);
    for (int size : problem_.parameter_blocks) first.push_back(first.back() + size);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(x.size());
    Eigen::VectorXd residual, part;
    for (std::size_t i = 0; i < problem_.residual_blocks.size(); ++i) {
      const auto& shape = problem_.residual_blocks[i];
      if (!shape.active) continue;
      residual.resize(shape.size);
      problem_.Residual(static_cast<int>(i),
                        Eigen::Map<Eigen::VectorXd>(residual.data(), shape.size));
      if (shape.robust && cauchy_scale_ > 0.0) {
        residual /= 1.0 + residual.squaredNorm() / (cauchy_scale_ * cauchy_scale_);
      }
      for (std::size_t k = 0; k < shape.parameter_blocks.size(); ++k) {
        const int block = shape.parameter_blocks[k];
        const int size = problem_.parameter_blocks[block];
        part.resize(static_cast<Eigen::Index>(shape.size) * size);
        Eigen::Map<LeastSquaresProblem::RowMajorMatrix> J(part.data(), shape.size, size);
        problem_.Jacobian(static_cast<int>(i), static_cast<int>(k), J);
        gradient.segment(first[block], size) += J.transpose() * residual;
      }
    }
    return gradient;
  }

  LeastSquaresProblem& problem_;
  double cauchy_scale_;
  std::set<int> held_;
  std::set<int> released_;  // once: so that it ends
};

/// Adds what one run of the solver says.
void Take(const ceres::Solver::Summary& summary, bool first, LeastSquaresResult& result) {
  const auto cost = [](double value) {  // Ceres says -1 where it never evaluated
    return value < 0.0 ? std::numeric_limits<double>::quiet_NaN() : value;
  };
  if (first) result.initial_cost = cost(summary.initial_cost);
  result.final_cost = cost(summary.final_cost);
  // The first entry is the starting point; there is none where that could not be evaluated.
  result.iterations += std::max(0, static_cast<int>(summary.iterations.size()) - 1);
  result.termination = Translate(summary.termination_type);
  result.message = summary.message;
}

}  // namespace

LeastSquaresResult Solve(LeastSquaresProblem& problem, const Eigen::VectorXd& x0,
                         const LeastSquaresOptions& options) {
  LeastSquaresResult result;
  result.x = x0;
  for (int i : problem.nonnegative) result.x[i] = std::max(0.0, result.x[i]);

  PointCallback callback(problem, result.x);
  ceres::CauchyLoss loss(options.cauchy_scale > 0.0 ? options.cauchy_scale : 1.0);
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.evaluation_callback = &callback;
  problem_options.disable_all_safety_checks = true;
  ceres::Problem ceres_problem(problem_options);
  const std::vector<double*> blocks = AddParameterBlocks(problem, result.x, ceres_problem);
  for (std::size_t i = 0; i < problem.residual_blocks.size(); ++i) {
    const auto& shape = problem.residual_blocks[i];
    if (!shape.active) continue;
    std::vector<double*> used;
    for (int k : shape.parameter_blocks) used.push_back(blocks[k]);
    const bool robust = shape.robust && options.cauchy_scale > 0.0;
    ceres_problem.AddResidualBlock(new BlockCost(problem, static_cast<int>(i)),
                                   robust ? &loss : nullptr, used);
  }

  const QuietLog quiet;
  const ceres::Solver::Options solver = SolverOptions(problem, blocks, options);
  ActiveSet bounds(problem, options, result.x);
  for (int round = 0; round < kMaxActiveSets; ++round) {
    bounds.Hold(blocks, ceres_problem);
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &ceres_problem, &summary);
    Take(summary, round == 0, result);
    if (result.termination == Termination::kFailure || !bounds.Update(result.x)) break;
  }
  return result;
}

}  // namespace elastocal
