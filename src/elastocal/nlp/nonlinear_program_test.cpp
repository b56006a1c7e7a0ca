// SPDX-License-Identifier: Apache-2.0
#include "elastocal/nlp/nonlinear_program.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

/// Problem 71 of Hock and Schittkowski (1981) with its two constraints in two blocks. The known
/// minimum is 17.0140173 at (1, 4.742994, 3.8211503, 1.3794082).
class HockSchittkowski71 : public NonlinearProgram {
 public:
  HockSchittkowski71() {
    lower = Eigen::VectorXd::Constant(4, 1.0);
    upper = Eigen::VectorXd::Constant(4, 5.0);
    constraint_lower = Eigen::Vector2d(25.0, 40.0);
    constraint_upper = Eigen::Vector2d(1e20, 40.0);
    jacobian_blocks = {{0, 2, 0, 2}, {0, 2, 2, 2}};
    jacobian_.resize(2);
  }
  bool Evaluate(const Eigen::VectorXd& x) override {
    x_ = x;
    values_ = Eigen::Vector2d(x.prod(), x.squaredNorm());
    Eigen::Matrix<double, 2, 4> J;
    for (int i = 0; i < 4; ++i) J(0, i) = x.prod() / x[i];
    J.row(1) = 2.0 * x.transpose();
    jacobian_[0] = J.leftCols(2);
    jacobian_[1] = J.rightCols(2);
    return true;
  }
  double Objective() const override { return x_[0] * x_[3] * (x_[0] + x_[1] + x_[2]) + x_[2]; }
  Eigen::VectorXd Gradient() override {
    const double sum = x_[0] + x_[1] + x_[2];
    return Eigen::Vector4d(x_[3] * (sum + x_[0]), x_[0] * x_[3], x_[0] * x_[3] + 1.0, x_[0] * sum);
  }
  const Eigen::VectorXd& Constraints() const override { return values_; }
  const std::vector<Eigen::MatrixXd>& Jacobian() const override { return jacobian_; }

 private:
  Eigen::VectorXd x_, values_;
  std::vector<Eigen::MatrixXd> jacobian_;
};

TEST(NonlinearProgram, FindsAKnownConstrainedMinimum) {
  HockSchittkowski71 program;
  const auto result = Solve(program, Eigen::Vector4d(1.0, 5.0, 5.0, 1.0), {});
  EXPECT_EQ(result.termination, Termination::kConverged);
  EXPECT_NEAR(result.objective, 17.0140173, 1e-5);  // of the order of the solver's tolerance
  EXPECT_NEAR(result.x[1], 4.742994, 1e-4);
  EXPECT_NEAR(program.Constraints()[1], 40.0, 1e-6);
}

TEST(NonlinearProgram, SaysWhenIterationsAreUsedUp) {
  HockSchittkowski71 program;
  NonlinearProgramOptions options;
  options.max_iterations = 2;
  const auto result = Solve(program, Eigen::Vector4d(1.0, 5.0, 5.0, 1.0), options);
  EXPECT_EQ(result.termination, Termination::kNoConvergence);
  EXPECT_TRUE((result.x.array() >= 1.0).all() && (result.x.array() <= 5.0).all());
}

/// sqrt(x) is not defined left of zero, where the Newton step from 4 leads.
class UndefinedBeyondZero : public NonlinearProgram {
 public:
  UndefinedBeyondZero() {
    lower = Eigen::VectorXd::Constant(1, -10.0);
    upper = Eigen::VectorXd::Constant(1, 10.0);
  }
  bool Evaluate(const Eigen::VectorXd& x) override {
    x_ = x[0];
    return x_ > 0.0;
  }
  double Objective() const override { return x_ - std::sqrt(x_); }
  Eigen::VectorXd Gradient() override {
    return Eigen::VectorXd::Constant(1, 1.0 - 0.5 / std::sqrt(x_));
  }
  const Eigen::VectorXd& Constraints() const override { return none_; }
  const std::vector<Eigen::MatrixXd>& Jacobian() const override { return no_blocks_; }

 private:
  double x_ = 0.0;
  Eigen::VectorXd none_;
  std::vector<Eigen::MatrixXd> no_blocks_;
};

TEST(NonlinearProgram, StepsBackWhereItIsUndefined) {
  UndefinedBeyondZero program;
  const auto result = Solve(program, Eigen::VectorXd::Constant(1, 4.0), {});
  EXPECT_EQ(result.termination, Termination::kConverged);
  EXPECT_NEAR(result.x[0], 0.25, 1e-4);
}

/// A program that throws when its value or its gradient is evaluated for the fifth time.
class Failing : public HockSchittkowski71 {
 public:
  explicit Failing(bool in_gradient) : in_gradient_(in_gradient) {}

  bool Evaluate(const Eigen::VectorXd& x) override {
    if (!in_gradient_) Count();
    return HockSchittkowski71::Evaluate(x);
  }
  Eigen::VectorXd Gradient() override {
    if (in_gradient_) Count();
    return HockSchittkowski71::Gradient();
  }

  int count = 0;

 private:
  void Count() {
    if (++count == 5) throw std::runtime_error("fifth");
  }
  bool in_gradient_;
};

TEST(NonlinearProgram, HandsAnExceptionOnAtOnce) {
  for (const bool in_gradient : {false, true}) {
    Failing program(in_gradient);
    EXPECT_THROW(Solve(program, Eigen::Vector4d(1.0, 5.0, 5.0, 1.0), {}), std::runtime_error);
    EXPECT_EQ(program.count, 5);
  }
}

}  // namespace
}  // namespace elastocal
