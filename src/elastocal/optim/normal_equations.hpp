// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "elastocal/optim/least_squares.hpp"

namespace elastocal {

/// Share of the unit variance of each row that a fit explains, one vector for each residual block.
struct ExplainedRows {
  std::vector<Eigen::VectorXd> all;
  std::vector<Eigen::VectorXd> by_nuisance;  ///< part of `all` that the nuisance would explain if
                                             ///< the unknowns were known
};

/// The normal equations H step = -gradient of a least-squares problem linearised at a point, with
/// its nuisance blocks eliminated (Schur complement). If residuals are in units of their standard
/// deviations, the inverse of H is the covariance of the unknowns when the nuisance is unknown as
/// well. Steps, uncertainties, variances and tests all follow from this one linearisation.
class NormalEquations {
 public:
  /// The problem must just have been evaluated with jacobians. Keeps a reference: residual blocks
  /// are read from the problem later, so it must not be evaluated elsewhere in between.
  explicit NormalEquations(const LeastSquaresProblem& problem);

  const std::vector<int>& unknowns() const { return unknowns_; }       ///< entries of x, ascending
  const Eigen::MatrixXd& information() const { return information_; }  ///< of the unknowns: H
  const Eigen::VectorXd& gradient() const { return gradient_; }  ///< of the cost by the unknowns
  /// Computes only the gradient anew, after the problem has been evaluated with jacobians at a
  /// nearby point, where the information is nearly the same.
  void UpdateGradient();
  /// Expected decrease of the cost by a step of the nuisance alone, while the unknowns stay.
  double NuisanceDecrease() const { return nuisance_decrease_; }
  /// Expected decrease of the cost by a step of all unknowns and the nuisance. `covariance` is the
  /// inverse of information().
  double Decrease(const Eigen::MatrixXd& covariance) const {
    return nuisance_decrease_ + 0.5 * gradient_.dot(covariance * gradient_);
  }

  /// For entries of x, their positions among the unknowns.
  std::vector<int> Positions(const std::vector<int>& entries) const;

  /// The step of all of x that belongs to a step of the unknowns: with the best step of the
  /// nuisance.
  Eigen::VectorXd Expand(const Eigen::VectorXd& step) const;

  /// Covariance of the predicted rows of a residual block, from the `covariance` of the unknowns.
  /// For an active block, this is the part of its unit covariance that the fit explains.
  Eigen::MatrixXd Explained(int block, const Eigen::MatrixXd& covariance) const;

  /// Diagonal of Explained for all residual blocks, in less time than block by block.
  ExplainedRows ExplainedVariances(const Eigen::MatrixXd& covariance) const;

  /// Contributions J' Q r of clusters of residual blocks to the gradient, unknowns x clusters.
  /// `residuals` (one vector for each block) take the place of those of the problem. `cluster` is
  /// the cluster of each block, -1: none. Blocks that share a nuisance block must be in one
  /// cluster.
  Eigen::MatrixXd Scores(const std::vector<Eigen::VectorXd>& residuals,
                         const std::vector<int>& cluster, int clusters) const;

  /// Products of a matrix A, given in the rows of a residual block, with the nuisance taken out. Q
  /// projects on what the nuisance does not explain, r is the residual, and J the Jacobian by the
  /// unknowns.
  struct Score {
    Eigen::VectorXd residual;     ///< A' Q r, one entry for each column of A
    Eigen::MatrixXd information;  ///< A' Q A, columns x columns of A
    Eigen::MatrixXd cross;        ///< A' Q J, columns of A x unknowns
  };
  Score Project(int block, const Eigen::MatrixXd& A) const;

  /// Effect of one more unknown, if it were estimated together with all others (score test, Rao
  /// 1948).
  struct Addition {
    double value = 0.0;     ///< its estimate
    double variance = 0.0;  ///< variance of the estimate, if residuals have unit variance
    double gain = 0.0;      ///< decrease of the sum of squares
  };
  /// Effects of several further unknowns, tried one by one. The derivative of the residuals by each
  /// is `derivative` (one vector for each block), times a factor for each cluster of residual
  /// blocks: `factors`, clusters x unknowns tried. Clusters are those of Scores. An unknown whose
  /// effect the others reproduce, all but 1e-6 of its square, has an Addition of zeros.
  std::vector<Addition> Add(const std::vector<Eigen::VectorXd>& derivative,
                            const std::vector<int>& cluster, const Eigen::MatrixXd& factors,
                            const Eigen::MatrixXd& covariance) const;

 private:
  /// The residual blocks that share a nuisance block.
  struct Group {
    std::vector<int> blocks;
    Eigen::Index first = 0;          ///< entry of x of the nuisance block
    Eigen::Index row = 0, size = 0;  ///< place of the nuisance among that of all groups
    Eigen::LLT<Eigen::MatrixXd> factor;
    Eigen::VectorXd own;  ///< step of the nuisance = -(own + Gain x step of the unknowns)
  };
  /// Layout of the derivatives of a residual block.
  struct Layout {
    int group = -1;                        ///< -1: without nuisance
    Eigen::Index nuisance = 0, width = 0;  ///< columns of the nuisance in the block's Jacobian
    Eigen::Index own = 0;                  ///< first column of the unknowns
    std::vector<int> unknowns;             ///< positions of these columns among the unknowns
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
