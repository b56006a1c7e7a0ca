// SPDX-License-Identifier: Apache-2.0
#include "elastocal/nlp/nonlinear_program.hpp"

#include <cmath>
#include <exception>

#include <IpIpoptApplication.hpp>
#include <IpSolveStatistics.hpp>
#include <IpTNLP.hpp>

#include "elastocal/nlp/quasi_newton.hpp"

namespace elastocal {
namespace {

using Ipopt::Index;
using Ipopt::Number;

/// Ipopt's view of a programme.
class IpoptProgram : public Ipopt::TNLP {
 public:
  IpoptProgram(NonlinearProgram& program, const Eigen::VectorXd& x0)
      : program_(program), x_(x0), hessian_(x0.size()) {}

  const Eigen::VectorXd& x() const { return x_; }
  double objective() const { return objective_; }
  Termination termination() const { return termination_; }
  void RethrowFailure() const {
    if (failure_) std::rethrow_exception(failure_);
  }

  bool get_nlp_info(Index& n, Index& m, Index& jacobian_entries, Index& hessian_entries,
                    IndexStyleEnum& style) override {
    n = static_cast<Index>(program_.lower.size());
    m = static_cast<Index>(program_.constraint_lower.size());
    jacobian_entries = 0;
    for (const auto& block : program_.jacobian_blocks)
      jacobian_entries += block.rows * block.columns;
    hessian_entries = n * (n + 1) / 2;
    style = C_STYLE;
    return true;
  }

  bool get_bounds_info(Index n, Number* lower, Number* upper, Index m, Number* constraint_lower,
                       Number* constraint_upper) override {
    Map(lower, n) = program_.lower;
    Map(upper, n) = program_.upper;
    Map(constraint_lower, m) = program_.constraint_lower;
    Map(constraint_upper, m) = program_.constraint_upper;
    return true;
  }

  bool get_starting_point(Index n, bool, Number* x, bool, Number*, Number*, Index, bool,
                          Number*) override {
    Map(x, n) = x_;
    return true;
  }

  bool eval_f(Index n, const Number* x, bool fresh, Number& value) override {
    return Guarded([&] {
      if (!Update(n, x, fresh)) return false;
      value = program_.Objective();
      return std::isfinite(value);
    });
  }

  bool eval_grad_f(Index n, const Number* x, bool fresh, Number* gradient) override {
    return Guarded([&] {
      if (!Update(n, x, fresh)) return false;
      Map(gradient, n) = program_.Gradient();
      return true;
    });
  }

  bool eval_g(Index n, const Number* x, bool fresh, Index m, Number* values) override {
    return Guarded([&] {
      if (!Update(n, x, fresh)) return false;
      Map(values, m) = program_.Constraints();
      return true;
    });
  }

  bool eval_jac_g(Index n, const Number* x, bool fresh, Index, Index, Index* rows, Index* columns,
                  Number* values) override {
    if (values == nullptr) {
      WriteStructure(rows, columns);
      return true;
    }
    return Guarded([&] {
      if (!Update(n, x, fresh)) return false;
      for (const Eigen::MatrixXd& block : program_.Jacobian()) {
        Map(values, static_cast<Index>(block.size())) = block.reshaped();
        values += block.size();
      }
      return true;
    });
  }

  bool eval_h(Index n, const Number* x, bool fresh, Number objective_factor, Index m,
              const Number* multipliers, bool, Index, Index* rows, Index* columns,
              Number* values) override {
    if (values == nullptr) {
      for (Index j = 0; j < n; ++j) {
        for (Index i = j; i < n; ++i) {
          *rows++ = i;
          *columns++ = j;
        }
      }
      return true;
    }
    return Guarded([&] {
      if (!Update(n, x, fresh)) return false;
      // While Ipopt restores feasibility, the objective plays no part and teaches nothing about its
      // curvature.
      if (objective_factor > 0.0) {
        LearnCurvature(objective_factor, Eigen::Map<const Eigen::VectorXd>(x, n),
                       Eigen::Map<const Eigen::VectorXd>(multipliers, m));
      }
      for (Index j = 0; j < n; ++j) {
        Map(values, n - j) = hessian_.hessian().col(j).tail(n - j);
        values += n - j;
      }
      return true;
    });
  }

  bool intermediate_callback(Ipopt::AlgorithmMode, Index, Number, Number, Number, Number, Number,
                             Number, Number, Number, Index, const Ipopt::IpoptData*,
                             Ipopt::IpoptCalculatedQuantities*) override {
    return !failure_;
  }

  void finalize_solution(Ipopt::SolverReturn status, Index n, const Number* x, const Number*,
                         const Number*, Index, const Number*, const Number*, Number objective,
                         const Ipopt::IpoptData*, Ipopt::IpoptCalculatedQuantities*) override {
    x_ = Eigen::Map<const Eigen::VectorXd>(x, n);
    objective_ = objective;
    termination_ = status == Ipopt::SUCCESS || status == Ipopt::STOP_AT_ACCEPTABLE_POINT
                       ? Termination::kConverged
                   : status == Ipopt::MAXITER_EXCEEDED ? Termination::kNoConvergence
                                                       : Termination::kFailure;
  }

 private:
  static Eigen::Map<Eigen::VectorXd> Map(Number* values, Index size) { return {values, size}; }

  /// Runs `work` and keeps an exception of the programme (or an interruption), which then ends the
  /// solve: Ipopt itself swallows exceptions.
  template <typename Work>
  bool Guarded(const Work& work) {
    if (failure_) return false;
    try {
      return work();
    } catch (...) {
      failure_ = std::current_exception();
      return false;
    }
  }

  bool Update(Index n, const Number* x, bool fresh) {
    if (fresh || !evaluated_) {
      defined_ = program_.Evaluate(Eigen::Map<const Eigen::VectorXd>(x, n));
      evaluated_ = true;
    }
    return defined_;
  }

  /// Gradients at a point.
  struct Slopes {
    Eigen::VectorXd x, objective;
    std::vector<Eigen::MatrixXd> constraints;
  };

  /// Gradient of the Lagrangian.
  Eigen::VectorXd Slope(const Slopes& at, double objective_factor,
                        const Eigen::VectorXd& multipliers) const {
    Eigen::VectorXd slope = objective_factor * at.objective;
    for (std::size_t b = 0; b < at.constraints.size(); ++b) {
      const auto& block = program_.jacobian_blocks[b];
      slope.segment(block.column, block.columns) +=
          at.constraints[b].transpose() * multipliers.segment(block.row, block.rows);
    }
    return slope;
  }

  /// Updates the Hessian by the step from the last iterate to this one. Both gradients use the
  /// multipliers of this one.
  void LearnCurvature(double objective_factor, const Eigen::VectorXd& x,
                      const Eigen::VectorXd& multipliers) {
    Slopes now{x, program_.Gradient(), program_.Jacobian()};
    if (last_.x.size() > 0) {
      hessian_.Update(now.x - last_.x, Slope(now, objective_factor, multipliers) -
                                           Slope(last_, objective_factor, multipliers));
    }
    last_ = std::move(now);
  }

  void WriteStructure(Index* rows, Index* columns) const {
    for (const auto& block : program_.jacobian_blocks) {
      for (int j = 0; j < block.columns; ++j) {
        for (int i = 0; i < block.rows; ++i) {
          *rows++ = block.row + i;
          *columns++ = block.column + j;
        }
      }
    }
  }

  NonlinearProgram& program_;
  Eigen::VectorXd x_;
  QuasiNewtonHessian hessian_;
  Slopes last_;
  double objective_ = NAN;
  Termination termination_ = Termination::kFailure;
  bool evaluated_ = false, defined_ = false;
  std::exception_ptr failure_;
};

void Configure(Ipopt::IpoptApplication& ipopt, const NonlinearProgramOptions& options) {
  Ipopt::OptionsList& list = *ipopt.Options();
  list.SetIntegerValue("print_level", 0);
  list.SetStringValue("sb", "yes");  // no banner
  list.SetIntegerValue("max_iter", options.max_iterations);
  list.SetNumericValue("tol", options.tolerance);
  list.SetNumericValue("constr_viol_tol", options.constraint_tolerance);
  list.SetNumericValue("bound_relax_factor", 0.0);  // bounds hold exactly
  list.SetNumericValue("mu_init", options.first_barrier);
  // Programmes of this size are assembled so fast that reordering gains nothing.
  list.SetIntegerValue("mumps_permuting_scaling", 0);
  list.SetIntegerValue("mumps_pivot_order", 0);
}

}  // namespace

NonlinearProgramResult Solve(NonlinearProgram& program, const Eigen::VectorXd& x0,
                             const NonlinearProgramOptions& options) {
  Ipopt::SmartPtr<Ipopt::IpoptApplication> ipopt = new Ipopt::IpoptApplication(false);
  Configure(*ipopt, options);
  NonlinearProgramResult result;
  result.x = x0;
  result.objective = NAN;
  if (ipopt->Initialize("") != Ipopt::Solve_Succeeded) {  // reads no ipopt.opt
    result.message = "Ipopt did not start";
    return result;
  }
  Ipopt::SmartPtr<IpoptProgram> view = new IpoptProgram(program, x0);
  const Ipopt::ApplicationReturnStatus status =
      ipopt->OptimizeTNLP(Ipopt::SmartPtr<Ipopt::TNLP>(GetRawPtr(view)));
  view->RethrowFailure();
  result.x = view->x();
  result.objective = view->objective();
  result.termination = view->termination();
  result.message = "Ipopt ended with status " + std::to_string(status);
  if (IsValid(ipopt->Statistics())) result.iterations = ipopt->Statistics()->IterationCount();
  return result;
}

}  // namespace elastocal
