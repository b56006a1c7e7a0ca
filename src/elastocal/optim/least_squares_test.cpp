#include "elastocal/optim/least_squares.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

/// 10 (y - x^2) and 1 - x: the minimum is 0 at (1, 1), at the end of a bent valley.
class Rosenbrock : public LeastSquaresProblem {
 public:
  Rosenbrock() {
    parameter_blocks = {1, 1};
    residual_blocks = {{.size = 1, .parameter_blocks = {0, 1}},
                       {.size = 1, .parameter_blocks = {0}}};
  }
  void Evaluate(const Eigen::VectorXd& x, bool) override {
    x_ = x;
    ++evaluations;
  }
  void Residual(int block, Eigen::Map<Eigen::VectorXd> residual) const override {
    residual[0] = block == 0 ? 10.0 * (x_[1] - x_[0] * x_[0]) : 1.0 - x_[0];
  }
  void Jacobian(int block, int k, Eigen::Map<RowMajorMatrix> jacobian) const override {
    if (block == 1) {
      jacobian(0, 0) = -1.0;
    } else {
      jacobian(0, 0) = k == 0 ? -20.0 * x_[0] : 10.0;
    }
  }
  int evaluations = 0;

 private:
  Eigen::Vector2d x_;
};

/// Curves y_ij = a exp(b t_j) + c_i: block 0 is (a, b), common to all; block i + 1 is c_i. Residual
/// block i holds the points of curve i, t_j = j / 10.
class Curves : public LeastSquaresProblem {
 public:
  Curves(const Eigen::MatrixXd& y, bool eliminate) : y_(y) {
    parameter_blocks = {2};
    for (int i = 0; i < y.rows(); ++i) {
      parameter_blocks.push_back(1);
      residual_blocks.push_back(
          {.size = static_cast<int>(y.cols()), .parameter_blocks = {0, i + 1}});
      if (eliminate) eliminated_blocks.push_back(i + 1);
    }
  }
  void Evaluate(const Eigen::VectorXd& x, bool) override { x_ = x; }
  void Residual(int block, Eigen::Map<Eigen::VectorXd> residual) const override {
    for (Eigen::Index j = 0; j < residual.size(); ++j) {
      residual[j] = x_[0] * Growth(j) + x_[2 + block] - y_(block, j);
    }
  }
  void Jacobian(int, int k, Eigen::Map<RowMajorMatrix> jacobian) const override {
    for (Eigen::Index j = 0; j < jacobian.rows(); ++j) {
      if (k == 1) {
        jacobian(j, 0) = 1.0;
      } else {
        jacobian(j, 0) = Growth(j);
        jacobian(j, 1) = x_[0] * 0.1 * static_cast<double>(j) * Growth(j);
      }
    }
  }

 private:
  double Growth(Eigen::Index j) const { return std::exp(x_[1] * 0.1 * static_cast<double>(j)); }

  Eigen::MatrixXd y_;
  Eigen::VectorXd x_;
};

/// Four curves of a = 2, b = -1, c_i = i, with a ripple that no parameter explains.
Eigen::MatrixXd MakeCurves() {
  Eigen::MatrixXd y(4, 15);
  for (int i = 0; i < y.rows(); ++i) {
    for (int j = 0; j < y.cols(); ++j) {
      y(i, j) = 2.0 * std::exp(-0.1 * j) + i + 0.01 * std::sin(5.0 * i + 3.0 * j);
    }
  }
  return y;
}

LeastSquaresResult FitCurves(const Eigen::MatrixXd& y, bool eliminate,
                             const LeastSquaresOptions& options = {}) {
  Curves problem(y, eliminate);
  Eigen::VectorXd x0 = Eigen::VectorXd::Zero(6);
  x0[0] = 1.0;
  return Solve(problem, x0, options);
}

/// Readings of one number, each a block of its own.
class Mean : public LeastSquaresProblem {
 public:
  explicit Mean(const Eigen::VectorXd& readings) : readings_(readings) {
    parameter_blocks = {1};
    residual_blocks.assign(readings.size(), {.size = 1, .parameter_blocks = {0}});
  }
  void Evaluate(const Eigen::VectorXd& x, bool) override { x_ = x[0]; }
  void Residual(int block, Eigen::Map<Eigen::VectorXd> residual) const override {
    residual[0] = x_ - readings_[block];
  }
  void Jacobian(int, int, Eigen::Map<RowMajorMatrix> jacobian) const override {
    jacobian(0, 0) = 1.0;
  }

 private:
  Eigen::VectorXd readings_;
  double x_ = 0.0;
};

TEST(LeastSquares, FollowsABentValley) {
  Rosenbrock problem;
  const LeastSquaresResult result = Solve(problem, Eigen::Vector2d(-1.2, 1.0), {});
  EXPECT_EQ(result.termination, Termination::kConverged);
  EXPECT_STREQ(TerminationName(result.termination), "converged");
  // A problem without residual is solved to rounding.
  EXPECT_LT((result.x - Eigen::Vector2d(1, 1)).norm(), 1e-12);
  EXPECT_NEAR(result.initial_cost, 0.5 * (4.4 * 4.4 + 2.2 * 2.2), 1e-13);
  EXPECT_LT(result.final_cost, 1e-24);
  EXPECT_GT(result.iterations, 3);
  EXPECT_FALSE(result.message.empty());
  // At most twice for each trial: once without, once with derivatives.
  EXPECT_LE(problem.evaluations, 2 * (result.iterations + 1));
}

TEST(LeastSquares, EliminationDoesNotChangeTheAnswer) {
  const LeastSquaresResult whole = FitCurves(MakeCurves(), false);
  const LeastSquaresResult reduced = FitCurves(MakeCurves(), true);
  EXPECT_EQ(whole.termination, Termination::kConverged);
  EXPECT_EQ(reduced.termination, Termination::kConverged);
  // Both stop when the cost stands still to 1e-14: the parameters are known to its root.
  EXPECT_LT((whole.x - reduced.x).norm(), 1e-7);
  EXPECT_NEAR(whole.final_cost, reduced.final_cost, 1e-12 * whole.final_cost);
  // And it is the answer: the ripple of 0.01 moves it by no more than that.
  const Eigen::VectorXd truth = (Eigen::VectorXd(6) << 2, -1, 0, 1, 2, 3).finished();
  EXPECT_LT((whole.x - truth).cwiseAbs().maxCoeff(), 0.02);
}

TEST(LeastSquares, CauchyLossResistsAnOutlier) {
  Eigen::VectorXd readings(5);
  readings << 0.9, 1.0, 1.1, 1.0, 11.0;
  Mean problem(readings);
  const Eigen::VectorXd x0 = Eigen::VectorXd::Zero(1);
  // The cost stands still to 1e-14 of itself, the solution to the root of that.
  EXPECT_NEAR(Solve(problem, x0, {}).x[0], readings.mean(), 1e-6);
  // The outlier still pulls, with weight 1 / (1 + (10 / 0.1)^2) = 1e-4 times 10 against some four.
  const double robust = Solve(problem, x0, {.cauchy_scale = 0.1}).x[0];
  EXPECT_NEAR(robust, 1.0, 1e-3);
  EXPECT_NE(robust, 1.0);
}

TEST(LeastSquares, TheLossSparesBlocksThatAreNotRobust) {
  Eigen::VectorXd readings(5);
  readings << 0.9, 1.0, 1.1, 1.0, 11.0;
  Mean problem(readings);
  for (auto& block : problem.residual_blocks) block.robust = false;
  EXPECT_NEAR(Solve(problem, Eigen::VectorXd::Zero(1), {.cauchy_scale = 0.1}).x[0], readings.mean(),
              1e-6);
}

TEST(LeastSquares, RobustCostIsThatOfTheFormula) {
  Mean problem(Eigen::Vector2d(-1, 1));
  const LeastSquaresResult result = Solve(problem, Eigen::VectorXd::Zero(1), {.cauchy_scale = 2});
  // 1/2 sum c^2 log(1 + s / c^2), at the symmetric point.
  EXPECT_NEAR(result.initial_cost, 4.0 * std::log(1.25), 1e-14);
}

TEST(LeastSquares, UsedUpIterationsAreNoConvergence) {
  Rosenbrock problem;
  const LeastSquaresResult result =
      Solve(problem, Eigen::Vector2d(-1.2, 1.0), {.max_iterations = 1});
  EXPECT_EQ(result.termination, Termination::kNoConvergence);
  EXPECT_STREQ(TerminationName(result.termination), "not converged");
  EXPECT_EQ(result.iterations, 1);
  EXPECT_LE(result.final_cost, result.initial_cost);
}

TEST(LeastSquares, AResidualThatIsNoNumberIsAFailure) {
  Mean problem(Eigen::Vector2d(1, std::numeric_limits<double>::quiet_NaN()));
  const LeastSquaresResult result = Solve(problem, Eigen::VectorXd::Constant(1, 7), {});
  EXPECT_EQ(result.termination, Termination::kFailure);
  EXPECT_STREQ(TerminationName(result.termination), "failed");
  EXPECT_EQ(result.x[0], 7.0);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_FALSE(result.message.empty());
}

TEST(LeastSquares, SameInputSameBits) {
  for (bool eliminate : {false, true}) {
    const LeastSquaresOptions options{.cauchy_scale = 0.01};
    const LeastSquaresResult a = FitCurves(MakeCurves(), eliminate, options);
    const LeastSquaresResult b = FitCurves(MakeCurves(), eliminate, options);
    EXPECT_EQ(a.x, b.x);
    EXPECT_EQ(a.final_cost, b.final_cost);
    EXPECT_EQ(a.iterations, b.iterations);
  }
}

}  // namespace
}  // namespace elastocal
