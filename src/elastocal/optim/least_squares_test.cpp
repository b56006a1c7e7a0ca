// SPDX-License-Identifier: Apache-2.0
#include "elastocal/optim/least_squares.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

/// A problem whose blocks are evaluated all at once.
class Stored : public LeastSquaresProblem {
 public:
  const Eigen::VectorXd& Residual(int block) const override { return residuals_[block]; }
  const RowMajorMatrix& Jacobian(int block) const override { return jacobians_[block]; }

 protected:
  void Resize() {
    residuals_.resize(residual_blocks.size());
    jacobians_.resize(residual_blocks.size());
  }
  std::vector<Eigen::VectorXd> residuals_;
  std::vector<RowMajorMatrix> jacobians_;
};

/// 10 (y - x^2) and 1 - x: their minimum is 0 at (1, 1), at the end of a curved valley.
class Rosenbrock : public Stored {
 public:
  Rosenbrock() {
    parameter_blocks = {1, 1};
    residual_blocks = {{.size = 1, .parameter_blocks = {0, 1}},
                       {.size = 1, .parameter_blocks = {0}}};
    Resize();
  }
  void Evaluate(const Eigen::VectorXd& x, bool) override {
    residuals_[0] = Eigen::VectorXd::Constant(1, 10.0 * (x[1] - x[0] * x[0]));
    residuals_[1] = Eigen::VectorXd::Constant(1, 1.0 - x[0]);
    jacobians_[0] = Eigen::RowVector2d(-20.0 * x[0], 10.0);
    jacobians_[1] = RowMajorMatrix::Constant(1, 1, -1.0);
    ++evaluations;
  }
  int evaluations = 0;
};

/// Curves y_ij = a exp(b t_j) + c_i with t_j = j / 10. Parameter block 0 is (a, b), common to all
/// curves, and block i + 1 is c_i. Residual block i holds the points of curve i.
class Curves : public Stored {
 public:
  Curves(const Eigen::MatrixXd& y, bool eliminate) : y_(y) {
    parameter_blocks = {2};
    for (int i = 0; i < y.rows(); ++i) {
      parameter_blocks.push_back(1);
      residual_blocks.push_back(
          {.size = static_cast<int>(y.cols()), .parameter_blocks = {0, i + 1}});
      if (eliminate) nuisance_blocks.push_back(i + 1);
    }
    Resize();
  }
  void Evaluate(const Eigen::VectorXd& x, bool) override {
    for (std::size_t i = 0; i < residuals_.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      residuals_[i].resize(y_.cols());
      jacobians_[i].resize(y_.cols(), 3);
      for (Eigen::Index j = 0; j < y_.cols(); ++j) {
        const double t = 0.1 * static_cast<double>(j);
        const double growth = std::exp(x[1] * t);
        residuals_[i][j] = x[0] * growth + x[2 + row] - y_(row, j);
        jacobians_[i].row(j) << growth, x[0] * t * growth, 1.0;
      }
    }
  }

 private:
  Eigen::MatrixXd y_;
};

/// Four curves with a = 2, b = -1 and c_i = i, and a ripple that no parameter explains.
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

/// Readings of one number. Each reading is a residual block.
class Mean : public Stored {
 public:
  explicit Mean(const Eigen::VectorXd& readings) : readings_(readings) {
    parameter_blocks = {1};
    residual_blocks.assign(readings.size(), {.size = 1, .parameter_blocks = {0}});
    Resize();
  }
  void Evaluate(const Eigen::VectorXd& x, bool) override {
    for (std::size_t i = 0; i < residuals_.size(); ++i) {
      residuals_[i] = x - readings_.segment<1>(static_cast<Eigen::Index>(i));
      jacobians_[i] = RowMajorMatrix::Ones(1, 1);
    }
  }

 private:
  Eigen::VectorXd readings_;
};

TEST(LeastSquares, FollowsABentValley) {
  Rosenbrock problem;
  const LeastSquaresResult result = Solve(problem, Eigen::Vector2d(-1.2, 1.0), {});
  EXPECT_EQ(result.termination, Termination::kConverged);
  EXPECT_STREQ(TerminationName(result.termination), "converged");
  // A problem whose residual vanishes is solved up to rounding.
  EXPECT_LT((result.x - Eigen::Vector2d(1, 1)).norm(), 1e-12);
  EXPECT_NEAR(result.initial_cost, 0.5 * (4.4 * 4.4 + 2.2 * 2.2), 1e-13);
  EXPECT_LT(result.final_cost, 1e-24);
  EXPECT_GT(result.iterations, 3);
  EXPECT_FALSE(result.message.empty());
  EXPECT_LT(problem.evaluations, 60);
}

TEST(LeastSquares, EliminationDoesNotChangeTheAnswer) {
  const LeastSquaresResult whole = FitCurves(MakeCurves(), false);
  const LeastSquaresResult reduced = FitCurves(MakeCurves(), true);
  EXPECT_EQ(whole.termination, Termination::kConverged);
  EXPECT_EQ(reduced.termination, Termination::kConverged);
  // Both solvers stop when the cost changes by less than 1e-14. The parameters are known to the
  // square root of this.
  EXPECT_LT((whole.x - reduced.x).norm(), 1e-7);
  EXPECT_NEAR(whole.final_cost, reduced.final_cost, 1e-12 * whole.final_cost);
  // The solution is the truth, apart from what the ripple of 0.01 changes.
  const Eigen::VectorXd truth = (Eigen::VectorXd(6) << 2, -1, 0, 1, 2, 3).finished();
  EXPECT_LT((whole.x - truth).cwiseAbs().maxCoeff(), 0.02);
}

// A block that takes no part in the fit is still evaluated.
TEST(LeastSquares, InactiveBlocksDoNotPull) {
  Eigen::VectorXd readings(5);
  readings << 0.9, 1.0, 1.1, 1.0, 11.0;
  Mean problem(readings);
  problem.residual_blocks[4].active = false;
  const LeastSquaresResult result = Solve(problem, Eigen::VectorXd::Zero(1));
  EXPECT_NEAR(result.x[0], 1.0, 1e-12);
  EXPECT_NEAR(result.final_cost, 0.5 * (0.01 + 0.01), 1e-12);
  EXPECT_NEAR(problem.Residual(4)[0], -10.0, 1e-9);
}

// The start is beyond the bound, and so is the minimum.
TEST(LeastSquares, BoundsHold) {
  Mean problem(Eigen::Vector3d(-1.0, -2.0, 0.5));
  problem.nonnegative = {0};
  const LeastSquaresResult result = Solve(problem, Eigen::VectorXd::Constant(1, -3.0));
  EXPECT_EQ(result.termination, Termination::kConverged);
  EXPECT_EQ(result.x[0], 0.0);
}

/// x and 1 + x^2 / 2: at the minimum 0, the curvature is twice that of the linearised problem. Its
/// full steps lead from x to nearly -x.
class Bowl : public Stored {
 public:
  Bowl() {
    parameter_blocks = {1};
    residual_blocks = {{.size = 2, .parameter_blocks = {0}}};
    Resize();
  }
  void Evaluate(const Eigen::VectorXd& x, bool) override {
    residuals_[0] = Eigen::Vector2d(x[0], 1.0 + 0.5 * x[0] * x[0]);
    jacobians_[0] = Eigen::Vector2d(1.0, x[0]);
  }
};

// With 100 full steps, x would be 0.05.
TEST(LeastSquares, StepsAcrossTheMinimumAreShortened) {
  Bowl problem;
  const LeastSquaresResult result = Solve(problem, Eigen::VectorXd::Constant(1, 0.1));
  EXPECT_EQ(result.termination, Termination::kConverged);
  EXPECT_LT(result.iterations, 10);
  EXPECT_LT(std::abs(result.x[0]), 1e-6);
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
    const LeastSquaresResult a = FitCurves(MakeCurves(), eliminate);
    const LeastSquaresResult b = FitCurves(MakeCurves(), eliminate);
    EXPECT_EQ(a.x, b.x);
    EXPECT_EQ(a.final_cost, b.final_cost);
    EXPECT_EQ(a.iterations, b.iterations);
  }
}

}  // namespace
}  // namespace elastocal
