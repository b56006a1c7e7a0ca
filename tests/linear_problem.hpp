#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/math/random.hpp"
#include "elastocal/optim/least_squares.hpp"

namespace elastocal {

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
  void Evaluate(const Eigen::VectorXd& x, bool) override { x_ = x; }
  /// J x plus the block's number, row by row.
  void Residual(int block, Eigen::Map<Eigen::VectorXd> residual) const override {
    residual = (All(block) * x_).array() + block;
  }
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

  /// Of the cost at x.
  Eigen::VectorXd Gradient(const Eigen::VectorXd& x) const {
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(9);
    for (std::size_t i = 0; i < all_.size(); ++i) {
      if (!residual_blocks[i].active) continue;
      const Eigen::VectorXd residual = (all_[i] * x).array() + static_cast<double>(i);
      gradient += all_[i].transpose() * residual;
    }
    return gradient;
  }

 private:
  Eigen::VectorXd x_ = Eigen::VectorXd::Zero(9);
  std::vector<RowMajorMatrix> all_;
};

}  // namespace elastocal
