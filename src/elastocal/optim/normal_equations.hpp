// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "elastocal/optim/least_squares.hpp"

namespace elastocal {

/// What a fit explains of the unit variance of each row, by residual block.
struct ExplainedRows {
  std::vector<Eigen::VectorXd> all;
  std::vector<Eigen::VectorXd> by_nuisance;  ///< part of it that the nuisance would explain if the
                                             ///< unknowns were known
};

/// The normal equations of a least-squares problem linearised at a point, its nuisance blocks
/// eliminated (Schur complement), as H step = -gradient. With residuals in units of their standard
/// deviations, the inverse of H is the covariance of the unknowns, the nuisance being unknown as
/// well. The one linearisation that steps, uncertainty, variances and tests are made from.
class NormalEquations {
 public:
  /// The problem must just have been evaluated with jacobians. Keeps a reference: residual blocks
  /// are read from the problem later, so it must not be evaluated elsewhere in between.
  explicit NormalEquations(const LeastSquaresProblem& problem);

  const std::vector<int>& unknowns() const { return unknowns_; }       ///< entries of x, ascending
  const Eigen::MatrixXd& information() const { return information_; }  ///< of these
  const Eigen::VectorXd& gradient() const { return gradient_; }        ///< of the cost by these
  /// Takes the gradient anew, the problem having been evaluated with jacobians at another point:
  /// near by, the information is much the same.
  void UpdateGradient();
  /// By how much the cost falls by the nuisance alone, the unknowns staying.
  double NuisanceDecrease() const { return nuisance_decrease_; }
  /// By how much it falls by all unknowns and the nuisance; `covariance`: inverse of information().
  double Decrease(const Eigen::MatrixXd& covariance) const {
    return nuisance_decrease_ + 0.5 * gradient_.dot(covariance * gradient_);
  }

  /// Where entries of x stand among the unknowns.
  std::vector<int> Positions(const std::vector<int>& entries) const;

  /// The step of all of x: that of the unknowns, and what the nuisance makes of it.
  Eigen::VectorXd Expand(const Eigen::VectorXd& step) const;

  /// Covariance of what is predicted for the rows of a residual block, given that of the unknowns:
  /// for an active block the part of its unit covariance that the fit explains.
  Eigen::MatrixXd Explained(int block, const Eigen::MatrixXd& covariance) const;

  /// Its diagonal, for all residual blocks (in less time than block by block).
  ExplainedRows ExplainedVariances(const Eigen::MatrixXd& covariance) const;

  /// Parts of the gradient, J' Q r, that clusters of residual blocks make: unknowns x clusters.
  /// `residuals`, by block, stand for those of the problem; `cluster`: of each block, -1: none.
  /// Blocks that share a nuisance block belong to one cluster.
  Eigen::MatrixXd Scores(const std::vector<Eigen::VectorXd>& residuals,
                         const std::vector<int>& cluster, int clusters) const;

  /// What is left of A, given in the rows of a residual block, beside the nuisance: with Q that
  /// projects on what the nuisance does not explain, A' Q r, A' Q A and A' Q J.
  struct Score {
    Eigen::VectorXd residual;     ///< columns of A
    Eigen::MatrixXd information;  ///< columns of A, squared
    Eigen::MatrixXd cross;        ///< columns of A x unknowns
  };
  Score Project(int block, const Eigen::MatrixXd& A) const;

  /// How much of one more unknown would explain what the residuals leave, all else being fitted
  /// beside it (score test, Rao 1948).
  struct Addition {
    double value = 0.0;     ///< the estimate
    double variance = 0.0;  ///< of it, where residuals have unit variance
    double gain = 0.0;      ///< by which the sum of squares would fall
  };
  /// What each of several further unknowns would bring, tried one by one. The derivative of the
  /// residuals by each is `derivative` (by block), times a factor of its own in every cluster of
  /// residual blocks: `factors`, clusters x unknowns tried. Clusters are those of Scores.
  std::vector<Addition> Add(const std::vector<Eigen::VectorXd>& derivative,
                            const std::vector<int>& cluster, const Eigen::MatrixXd& factors,
                            const Eigen::MatrixXd& covariance) const;

 private:
  /// The residual blocks that share a nuisance block.
  struct Group {
    std::vector<int> blocks;
    Eigen::Index first = 0;          ///< entry of x of the nuisance block
    Eigen::Index row = 0, size = 0;  ///< of the nuisance among that of all groups
    Eigen::LLT<Eigen::MatrixXd> factor;
    Eigen::VectorXd own;  ///< step of the nuisance = -(own + Gain x step of the unknowns)
  };
  /// Where the derivatives of a residual block stand.
  struct Layout {
    int group = -1;                        ///< -1: without nuisance
    Eigen::Index nuisance = 0, width = 0;  ///< its columns in the block's Jacobian
    Eigen::Index own = 0;                  ///< first column of the others
    std::vector<int> unknowns;             ///< where these stand among the unknowns
  };

  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using Columns = Eigen::Block<const Rows, Eigen::Dynamic, Eigen::Dynamic>;

  void LayOut();
  void FindAlike();
  void AddBlocks(const std::vector<int>& blocks);
  void EliminateNuisance();
  std::vector<std::vector<Group*>> Batches();
  auto Gain(const Group& group) const {
    return gains_.middleCols(group.row, group.size).transpose();
  }
  Columns OwnJacobian(int block) const;
  Eigen::MatrixXd OwnGradients(const std::vector<int>& blocks) const;
  Columns NuisanceJacobian(int block) const;
  /// Whether an active block is one of a cluster, see Scores.
  bool IsIn(const std::vector<int>& cluster, int block) const;

  const LeastSquaresProblem& problem_;
  std::vector<int> unknowns_, position_;  // position_: of an entry of x among the unknowns; -1
  std::vector<Layout> layout_;            // by residual block
  // Blocks of the same unknowns, in batches: one large product takes less time than many small
  // ones.
  std::vector<std::vector<int>> alike_;
  std::vector<Group> groups_;
  Eigen::Index nuisance_rows_ = 0;
  Eigen::MatrixXd gains_;  // unknowns x nuisance of all groups: each Gain, transposed
  Eigen::MatrixXd information_;
  Eigen::VectorXd gradient_;
  double nuisance_decrease_ = 0.0;
};

/// The cost of a problem as last evaluated, see LeastSquaresProblem.
double CostOf(const LeastSquaresProblem& problem);

}  // namespace elastocal
