#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/optim/least_squares.hpp"

namespace elastocal {

/// A least-squares problem linearised at a point, without the loss, and with nuisance blocks of its
/// unknowns eliminated (Schur complement): what the residuals say about the others.
///
/// With residuals in units of their standard deviations the inverse of `information` is the
/// covariance of the unknowns, the nuisance being unknown as well.
struct Linearisation {
  /// Residual blocks that share a nuisance block or, without one, all the blocks that they meet.
  struct Group {
    std::vector<int> blocks;     ///< residual blocks, in order
    std::vector<int> first_row;  ///< of each in the matrices below
    std::vector<int> columns;    ///< those of `unknowns` that it depends on, ascending
    Eigen::MatrixXd jacobian;    ///< rows x columns, less what the nuisance explains
    Eigen::MatrixXd nuisance;    ///< rows x rows: covariance that the nuisance's own uncertainty
                                 ///< gives to the residuals; empty without nuisance
  };
  std::vector<int> unknowns;    ///< entries of x that are no nuisance, ascending
  Eigen::MatrixXd information;  ///< of these, from the active residual blocks
  std::vector<Group> groups;
};

/// Linearises at `x`. No residual block may meet two nuisance blocks. Inactive residual blocks
/// appear in the groups but give no information.
Linearisation Linearise(LeastSquaresProblem& problem, const Eigen::VectorXd& x,
                        const std::vector<int>& nuisance_blocks);

/// Covariance of the values predicted for each residual block (size x size), given the covariance
/// of the unknowns: for an active block the part of its unit covariance that the fit explains.
std::vector<Eigen::MatrixXd> ExplainedCovariances(const Linearisation& linearisation,
                                                  const Eigen::MatrixXd& covariance);

}  // namespace elastocal
