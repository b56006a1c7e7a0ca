#include "elastocal/optim/normal_equations.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "elastocal/optim/linearisation.hpp"
#include "tests/linear_problem.hpp"

namespace elastocal {
namespace {

/// Two components that share nuisance blocks, and a third for the inactive block; the one without
/// nuisance is of none.
std::vector<std::vector<int>> Components(const LinearProblem& problem) {
  std::vector<std::vector<int>> components;
  for (std::size_t i = 0; i < problem.residual_blocks.size(); ++i) {
    components.push_back(i % 5 == 4 ? std::vector<int>{1, 1, 0} : std::vector<int>{0, 0, 0});
  }
  components[15] = {-1};
  components[16] = {2, 2, 2};
  return components;
}

TEST(NormalEquations, StepIsThatOfTheWholeProblem) {
  LinearProblem problem;
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(9, -1.0, 2.0);
  const NormalEquations equations(problem, x, {2, 3, 4}, Components(problem));
  EXPECT_EQ(equations.unknowns(), (std::vector<int>{0, 1, 2}));
  const Eigen::VectorXd step =
      equations.Expand(-equations.information().inverse() * equations.gradient());
  const Eigen::VectorXd whole = -problem.Information().inverse() * problem.Gradient(x);
  // Linear: the ridge of 1e-12 on the nuisance is all that differs.
  EXPECT_LT((step - whole).norm(), 1e-9);
  EXPECT_LT(problem.Gradient(x + step).norm(), 1e-8);
}

TEST(NormalEquations, ExplainedRowsAreTheTracesOfTheirCovariances) {
  LinearProblem problem;
  const Eigen::VectorXd x = Eigen::VectorXd::Zero(9);
  const auto components = Components(problem);
  const NormalEquations equations(problem, x, {2, 3, 4}, components);
  const Linearisation linearisation = Linearise(problem, x, {2, 3, 4});
  EXPECT_LT((equations.information() - linearisation.information).norm(), 1e-10);
  const Eigen::MatrixXd covariance = equations.information().inverse();
  const auto explained = ExplainedCovariances(linearisation, covariance);
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(3);
  for (std::size_t i = 0; i < components.size(); ++i) {
    if (!problem.residual_blocks[i].active) continue;
    for (std::size_t row = 0; row < components[i].size(); ++row) {
      const auto k = static_cast<Eigen::Index>(row);
      if (components[i][row] >= 0) expected[components[i][row]] += explained[i](k, k);
    }
  }
  EXPECT_LT((equations.Explained(covariance) - expected).norm(), 1e-9);
  EXPECT_GT(expected[1], 0.1);
  EXPECT_EQ(expected[2], 0.0);  // inactive
}

// There are several minima under the loss; the reweighted steps end in one of them.
TEST(NormalEquations, ReweightedStepsLeadToAMinimumUnderTheLoss) {
  LinearProblem problem;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(9);
  constexpr double kScale = 10.0;  // with much less than the residuals it creeps
  double cost = 0.0;
  for (int step = 0; step < 500; ++step) {
    const NormalEquations equations(problem, x, {2, 3, 4}, Components(problem), kScale);
    EXPECT_TRUE(step == 0 || equations.cost() <= cost * (1.0 + 1e-12));  // never uphill
    cost = equations.cost();
    x += equations.Expand(-equations.information().inverse() * equations.gradient());
  }
  Random random(4);
  for (int direction = 0; direction < 50; ++direction) {
    problem.Evaluate(x + random.NormalVector(9, 1e-3), false);
    EXPECT_GT(CostOf(problem, kScale), cost);
  }
}

TEST(NormalEquations, WithoutNuisanceTheyAreTheWholeProblem) {
  LinearProblem problem;
  const Eigen::VectorXd x = Eigen::VectorXd::Ones(9);
  const NormalEquations equations(problem, x, {}, Components(problem));
  EXPECT_LT((equations.information() - problem.Information()).norm(), 1e-11);
  EXPECT_LT((equations.gradient() - problem.Gradient(x)).norm(), 1e-11);
}

TEST(BoundedStep, StopsAtZeroAndLeavesItAgain) {
  // (d0 - 1)^2 + (d0 + d1)^2 from x = (0, 0.25): free d1 = -1 would make x1 = -0.75.
  Eigen::Matrix2d H;
  H << 4, 2, 2, 2;
  const Eigen::Vector2d g(-2, 0);
  const Eigen::Vector2d x(0.0, 0.25);
  EXPECT_LT((BoundedStep(H, g, x, {}) - Eigen::Vector2d(1, -1)).norm(), 1e-12);
  // d1 = -0.25 held: 2 (d0 - 1) + 2 (d0 - 0.25) = 0.
  EXPECT_LT((BoundedStep(H, g, x, {1}) - Eigen::Vector2d(0.625, -0.25)).norm(), 1e-12);
  // At the bound, with a slope that leads away from it: held at once. Towards inside: free.
  EXPECT_EQ(BoundedStep(H, Eigen::Vector2d(2, 0), Eigen::Vector2d(0, 5), {0}),
            Eigen::Vector2d(0, 0));
  EXPECT_LT((BoundedStep(H, g, Eigen::Vector2d(0, 5), {0}) - Eigen::Vector2d(1, -1)).norm(), 1e-12);
}

}  // namespace
}  // namespace elastocal
