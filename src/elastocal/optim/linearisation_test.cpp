#include "elastocal/optim/linearisation.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/linear_problem.hpp"

namespace elastocal {
namespace {

TEST(Linearisation, CovarianceIsThatOfTheWholeProblem) {
  LinearProblem problem;
  const Linearisation linearisation = Linearise(problem, Eigen::VectorXd::Zero(9), {2, 3, 4});
  EXPECT_EQ(linearisation.unknowns, (std::vector<int>{0, 1, 2}));
  const Eigen::MatrixXd whole = problem.Information().inverse();
  const Eigen::MatrixXd covariance = linearisation.information.inverse();
  EXPECT_LT((covariance - whole.topLeftCorner<3, 3>()).norm(), 1e-10);

  const std::vector<Eigen::MatrixXd> explained = ExplainedCovariances(linearisation, covariance);
  ASSERT_EQ(explained.size(), problem.residual_blocks.size());
  for (std::size_t i = 0; i < explained.size(); ++i) {
    const auto& J = problem.All(static_cast<int>(i));
    EXPECT_LT((explained[i] - J * whole * J.transpose()).norm(), 1e-9) << i;
  }
}

TEST(Linearisation, WithoutNuisanceItIsJustTheInformation) {
  LinearProblem problem;
  const Linearisation linearisation = Linearise(problem, Eigen::VectorXd::Zero(9), {});
  EXPECT_LT((linearisation.information - problem.Information()).norm(), 1e-12);
}

TEST(LeastSquares, UnknownsMayBeBoundedAtZero) {
  /// Minimum of (x - a)^2 for each unknown: at a where that is positive, else at the bound.
  struct Distances : LeastSquaresProblem {
    Eigen::VectorXd x, target = Eigen::Vector2d(3.0, -2.0);
    Distances() {
      parameter_blocks = {2};
      residual_blocks = {{2, {0}}};
      nonnegative = {0, 1};
    }
    void Evaluate(const Eigen::VectorXd& at, bool) override { x = at; }
    void Residual(int, Eigen::Map<Eigen::VectorXd> residual) const override {
      residual = x - target;
    }
    void Jacobian(int, int, Eigen::Map<RowMajorMatrix> jacobian) const override {
      jacobian.setIdentity();
    }
  } problem;
  const LeastSquaresResult result = Solve(problem, Eigen::Vector2d(1.0, 1.0), {});
  EXPECT_EQ(result.termination, Termination::kConverged);
  EXPECT_NEAR(result.x[0], 3.0, 1e-7);  // one damped step: 1e-8 short
  EXPECT_EQ(result.x[1], 0.0);
}

}  // namespace
}  // namespace elastocal
