// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/math/random.hpp"
#include "elastocal/optim/least_squares.hpp"

namespace elastocal {

/// A linear problem: two shared parameter blocks (2 and 1 unknowns) and three nuisance blocks of 2.
/// There are five residual blocks for each nuisance block, one prior, and one inactive block.
class LinearProblem : public LeastSquaresProblem {
 public:
  LinearProblem() {
    parameter_blocks = {2, 1, 2, 2, 2};
    Random random(3);
    const auto add = [&](const std::vector<int>& blocks, int size) {
      RowMajorMatrix all = RowMajorMatrix::Zero(size, 9);
      RowMajorMatrix own(size, 0);
      for (int k : blocks) {
        const int width = parameter_blocks[k];
        own.conservativeResize(size, own.cols() + width);
        for (int i = 0; i < size; ++i) {
          for (int c = 0; c < width; ++c) all(i, First(k) + c) = random.Normal(1.0);
        }
        own.rightCols(width) = all.middleCols(First(k), width);
      }
      all_.push_back(all);
      own_.push_back(own);
      residual_blocks.push_back({size, blocks, true});
    };
    nuisance_blocks = {2, 3, 4};
    for (int s = 2; s < 5; ++s) {
      for (int i = 0; i < 5; ++i) add({s, 0, 1}, 3);
    }
    add({1}, 1);
    add({0, 3}, 3);
    residual_blocks.back().active = false;
  }
  void Evaluate(const Eigen::VectorXd& x, bool) override {
    residuals_.clear();
    for (std::size_t i = 0; i < all_.size(); ++i) {
      residuals_.emplace_back((all_[i] * x).array() + static_cast<double>(i));
    }
  }
  /// J x plus the number of the block in each row.
  const Eigen::VectorXd& Residual(int block) const override { return residuals_[block]; }
  const RowMajorMatrix& Jacobian(int block) const override { return own_[block]; }
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

  /// Gradient of the cost at x.
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
  std::vector<RowMajorMatrix> all_, own_;  // own_: side by side as the block lists them
  std::vector<Eigen::VectorXd> residuals_;
};

}  // namespace elastocal
