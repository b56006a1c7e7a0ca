#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/optim/least_squares.hpp"

namespace elastocal {

/// The normal equations of a least-squares problem linearised at a point, its nuisance blocks
/// eliminated (Schur complement), as H step = -gradient. Cheaper than Linearise, which gives the
/// covariance of every single residual; here those that share a standard deviation (a component of
/// variance) are one. Under Cauchy's loss each residual block counts with its weight at the point,
/// 1 / (1 + |f|^2 / c^2) (iteratively reweighted least squares).
class NormalEquations {
 public:
  /// `components`: by residual block, the component of each of its rows, equal ones side by side;
  /// -1: of none. No residual block may meet two nuisance blocks.
  NormalEquations(LeastSquaresProblem& problem, const Eigen::VectorXd& x,
                  const std::vector<int>& nuisance_blocks,
                  const std::vector<std::vector<int>>& components, double cauchy_scale = 0.0);

  const std::vector<int>& unknowns() const { return unknowns_; }       ///< entries of x, ascending
  const Eigen::MatrixXd& information() const { return information_; }  ///< of these
  const Eigen::VectorXd& gradient() const { return gradient_; }        ///< of the cost by these
  double cost() const { return cost_; }  ///< at the point, loss included

  /// By component, how many of its rows the fit explains, given the covariance of the unknowns: the
  /// trace of the covariance of what is predicted for them.
  Eigen::VectorXd Explained(const Eigen::MatrixXd& covariance) const;

  /// The step of all of x: that of the unknowns, and what the nuisance makes of it.
  Eigen::VectorXd Expand(const Eigen::VectorXd& step) const;

 private:
  class Builder;

  /// What is left of an eliminated block: its step is -(own + gain x step of `columns`).
  struct Eliminated {
    int first = 0;  ///< entry of x
    std::vector<int> columns;
    Eigen::MatrixXd gain;
    Eigen::VectorXd own;
  };
  /// Rows of a component that is not the main one of those that share a nuisance block, less what
  /// this explains.
  struct MinorRows {
    int main = 0, component = 0;
    std::size_t eliminated = 0;
    Eigen::MatrixXd rows;  ///< x columns of the eliminated block
  };

  std::vector<int> unknowns_;
  Eigen::Index size_ = 0;  ///< of x
  Eigen::MatrixXd information_;
  Eigen::VectorXd gradient_;
  double cost_ = 0.0;
  std::vector<Eigen::MatrixXd> by_component_;  ///< information of the groups of each main component
  Eigen::VectorXd by_nuisance_;                ///< rows that the nuisance explains
  std::vector<Eliminated> eliminated_;
  std::vector<MinorRows> minor_;
};

/// The cost of a problem as last evaluated, see LeastSquaresProblem.
double CostOf(const LeastSquaresProblem& problem, double cauchy_scale = 0.0);

/// The step that minimises g'd + d'Hd/2 where the entries `nonnegative` of x + d may not become
/// negative (an active set; `information` positive definite).
Eigen::VectorXd BoundedStep(const Eigen::MatrixXd& information, const Eigen::VectorXd& gradient,
                            const Eigen::VectorXd& x, const std::vector<int>& nonnegative);

}  // namespace elastocal
