#include "elastocal/optim/linearisation.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

/// Linear: two shared blocks (2 and 1 unknowns), three nuisance blocks of 2; five residual blocks a
/// nuisance, one prior, one inactive block.
class LinearProblem : public LeastSquaresProblem {
 public:
  LinearProblem() {
    parameter_blocks = {2, 1, 2, 2, 2};
    Random random(3);
    const auto add = [&](std::vector<int> blocks, int size) {
      ResidualBlock block{size, blocks, true, true};
      int row = 0;
      for (const RowMajorMatrix& J : all_) row += static_cast<int>(J.rows());
      RowMajorMatrix J = RowMajorMatrix::Zero(size, 9);
      for (int k : blocks) {
        for (int i = 0; i < size; ++i) {
          for (int c = 0; c < parameter_blocks[k]; ++c) J(i, First(k) + c) = random.Normal(1.0);
        }
      }
      all_.push_back(J);
      residual_blocks.push_back(block);
    };
    for (int s = 2; s < 5; ++s) {
      for (int i = 0; i < 5; ++i) add({0, s, 1}, 3);
    }
    add({1}, 1);
    add({0, 3}, 3);
    residual_blocks.back().active = false;
  }
  void Evaluate(const Eigen::VectorXd&, bool) override {}
  void Residual(int, Eigen::Map<Eigen::VectorXd> residual) const override { residual.setZero(); }
  void Jacobian(int block, int k, Eigen::Map<RowMajorMatrix> jacobian) const override {
    jacobian = Part(block, residual_blocks[block].parameter_blocks[k]);
  }
  RowMajorMatrix Part(int block, int k) const {
    return all_[block].middleCols(First(k), parameter_blocks[k]);
  }
  int First(int k) const {
    int first = 0;
    for (int i = 0; i < k; ++i) first += parameter_blocks[i];
    return first;
  }
  const RowMajorMatrix& All(int block) const { return all_[block]; }
  Eigen::MatrixXd Information() const {
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(9, 9);
    for (std::size_t i = 0; i < all_.size(); ++i) {
      if (residual_blocks[i].active) information += all_[i].transpose() * all_[i];
    }
    return information;
  }

 private:
  std::vector<RowMajorMatrix> all_;
};

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
