// SPDX-License-Identifier: Apache-2.0
#include "elastocal/optim/normal_equations.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/linear_problem.hpp"

namespace elastocal {
namespace {

class NormalEquationsTest : public ::testing::Test {
 protected:
  NormalEquations At(const Eigen::VectorXd& x) {
    problem_.Evaluate(x, true);
    return NormalEquations(problem_);
  }
  int blocks() const { return static_cast<int>(problem_.residual_blocks.size()); }
  /// Rows of a block, with all columns.
  Eigen::MatrixXd Rows(int block) const { return problem_.All(block); }

  LinearProblem problem_;
};

TEST_F(NormalEquationsTest, StepIsThatOfTheWholeProblem) {
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(9, -1.0, 2.0);
  const NormalEquations equations = At(x);
  EXPECT_EQ(equations.unknowns(), (std::vector<int>{0, 1, 2}));
  const Eigen::VectorXd step =
      equations.Expand(-equations.information().inverse() * equations.gradient());
  const Eigen::VectorXd whole = -problem_.Information().inverse() * problem_.Gradient(x);
  // The problem is linear. Only the ridge of 1e-12 on the nuisance parameters makes a difference.
  EXPECT_LT((step - whole).norm(), 1e-9);
  EXPECT_LT(problem_.Gradient(x + step).norm(), 1e-8);
}

// The cost falls by the sum of what the step and the nuisance parameters predict.
TEST_F(NormalEquationsTest, DecreaseIsThatOfTheCost) {
  const Eigen::VectorXd x = Eigen::VectorXd::Ones(9);
  const NormalEquations equations = At(x);
  const double before = CostOf(problem_);
  const Eigen::VectorXd step = -equations.information().inverse() * equations.gradient();
  problem_.Evaluate(x + equations.Expand(step), false);
  const double expected = -0.5 * equations.gradient().dot(step) + equations.NuisanceDecrease();
  EXPECT_NEAR(before - CostOf(problem_), expected, 1e-9 * before);
}

TEST_F(NormalEquationsTest, ExplainedIsTheCovarianceOfThePrediction) {
  const NormalEquations equations = At(Eigen::VectorXd::Zero(9));
  const Eigen::MatrixXd covariance = equations.information().inverse();
  const Eigen::MatrixXd whole = problem_.Information().inverse();
  const ExplainedRows explained = equations.ExplainedVariances(covariance);
  const Eigen::MatrixXd known = Eigen::MatrixXd::Zero(covariance.rows(), covariance.cols());
  for (int block = 0; block < blocks(); ++block) {
    const Eigen::MatrixXd expected = Rows(block) * whole * Rows(block).transpose();
    EXPECT_LT((equations.Explained(block, covariance) - expected).norm(), 1e-9) << block;
    EXPECT_LT((explained.all[block] - expected.diagonal()).norm(), 1e-9) << block;
    EXPECT_LT((explained.by_nuisance[block] - equations.Explained(block, known).diagonal()).norm(),
              1e-9)
        << block;
  }
}

// The projection leaves the part of A that the nuisance parameters do not explain. The dense
// formula gives the same.
TEST_F(NormalEquationsTest, ProjectionIsThatOfTheDenseProblem) {
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(9, 1.0, 0.0);
  const NormalEquations equations = At(x);
  constexpr int kBlock = 6;  // residual block that belongs to nuisance block 3, the second
  const Eigen::MatrixXd A = (Eigen::MatrixXd(3, 2) << 1, 2, -1, 0, 0.5, 3).finished();
  Eigen::Matrix2d D = Eigen::Matrix2d::Zero();
  Eigen::MatrixXd EJ = Eigen::MatrixXd::Zero(2, 3);
  Eigen::Vector2d Er = Eigen::Vector2d::Zero();
  for (int block = 5; block < 10; ++block) {
    const Eigen::MatrixXd E = Rows(block).middleCols(5, 2);
    D += E.transpose() * E;
    EJ += E.transpose() * Rows(block).leftCols(3);
    Er += E.transpose() * problem_.Residual(block);
  }
  const Eigen::MatrixXd AE = A.transpose() * Rows(kBlock).middleCols(5, 2);
  const NormalEquations::Score score = equations.Project(kBlock, A);
  EXPECT_LT(
      (score.residual - (A.transpose() * problem_.Residual(kBlock) - AE * D.inverse() * Er)).norm(),
      1e-9);
  EXPECT_LT((score.information - (A.transpose() * A - AE * D.inverse() * AE.transpose())).norm(),
            1e-9);
  EXPECT_LT(
      (score.cross - (A.transpose() * Rows(kBlock).leftCols(3) - AE * D.inverse() * EJ)).norm(),
      1e-9);
}

TEST_F(NormalEquationsTest, ScoresOfAllClustersAddUpToTheGradient) {
  const NormalEquations equations = At(Eigen::VectorXd::Ones(9));
  std::vector<Eigen::VectorXd> residuals;
  std::vector<int> cluster;
  for (int block = 0; block < blocks(); ++block) {
    residuals.push_back(problem_.Residual(block));
    cluster.push_back(block < 15 ? block / 5 : 3);
  }
  const Eigen::MatrixXd scores = equations.Scores(residuals, cluster, 4);
  EXPECT_LT((scores.rowwise().sum() - equations.gradient()).norm(), 1e-9);
  EXPECT_GT(scores.col(1).norm(), 1e-3);
}

// Adding an unknown gives the same as solving the whole problem with one more column.
TEST_F(NormalEquationsTest, AdditionIsThatOfTheWholeProblem) {
  const NormalEquations equations = At(Eigen::VectorXd::LinSpaced(9, -1.0, 2.0));
  std::vector<Eigen::VectorXd> derivative;
  std::vector<int> cluster;
  for (int block = 0; block < blocks(); ++block) {
    const Eigen::Index rows = problem_.Residual(block).size();
    derivative.emplace_back(Eigen::VectorXd::LinSpaced(rows, 0.2 * block, 1.0));
    cluster.push_back(block < 15 ? block / 5 : -1);
  }
  const Eigen::MatrixXd factors = (Eigen::MatrixXd(3, 2) << 1, 0, 1, 2, 1, -1).finished();
  const auto additions =
      equations.Add(derivative, cluster, factors, equations.information().inverse());
  ASSERT_EQ(additions.size(), 2u);
  for (Eigen::Index k = 0; k < 2; ++k) {
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(10, 10);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(10);
    for (int block = 0; block < blocks(); ++block) {
      if (!problem_.residual_blocks[block].active) continue;
      const double factor = cluster[block] < 0 ? 0.0 : factors(cluster[block], k);
      Eigen::MatrixXd J(Rows(block).rows(), 10);
      J << Rows(block), factor * derivative[block];
      H += J.transpose() * J;
      g += J.transpose() * problem_.Residual(block);
    }
    const Eigen::MatrixXd covariance = H.inverse();
    const double value = -(covariance * g)[9];
    const NormalEquations::Addition& found = additions[static_cast<std::size_t>(k)];
    EXPECT_NEAR(found.value, value, 1e-8 * std::abs(value)) << k;
    EXPECT_NEAR(found.variance, covariance(9, 9), 1e-8 * covariance(9, 9)) << k;
    EXPECT_NEAR(found.gain, value * value / covariance(9, 9), 1e-8 * found.gain) << k;
  }
}

TEST_F(NormalEquationsTest, WithoutNuisanceTheyAreTheWholeProblem) {
  problem_.nuisance_blocks.clear();
  const Eigen::VectorXd x = Eigen::VectorXd::Ones(9);
  const NormalEquations equations = At(x);
  EXPECT_LT((equations.information() - problem_.Information()).norm(), 1e-11);
  EXPECT_LT((equations.gradient() - problem_.Gradient(x)).norm(), 1e-11);
  EXPECT_EQ(equations.NuisanceDecrease(), 0.0);
}

}  // namespace
}  // namespace elastocal
