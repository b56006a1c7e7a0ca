#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/options.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/optim/least_squares.hpp"
#include "elastocal/robot/jacobian.hpp"

namespace elastocal {

/// postures x markers: which observations take part.
using ObservationMask = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>;

/// Observations that are there at all.
ObservationMask SeenMask(const Recording& recording);

/// Scale of each parameter in the solver: its prior standard deviation, or for one without prior
/// 0.01 (m or rad). Of similar influence in these units, whatever the parameter.
double ParameterScale(const Parameter& parameter, const Prior& prior);

/// Eq. 14 without its constraint as a least-squares problem: for every observation the difference
/// between measured and predicted marker position over the standard deviation of a marker
/// coordinate, and for every parameter with a prior its deviation over the prior's.
///
/// The unknowns are the free parameters in units of ParameterScale, in blocks: T0, each joint, each
/// marker. An observation meets one marker block, so that these are eliminated first.
class MarkerResiduals : public LeastSquaresProblem {
 public:
  /// `free`: indices of the estimated parameters, ascending; all others stay at `fixed` (one value
  /// a parameter). Keeps references: model and recording must outlive it.
  MarkerResiduals(const ErrorModel& model, const Recording& recording, const ObservationMask& mask,
                  const std::vector<int>& free, const Eigen::VectorXd& fixed, const Prior& prior,
                  double marker_sd);

  /// Between the unknowns and the model's vector of errors.
  Eigen::VectorXd ToErrors(const Eigen::VectorXd& x) const;
  Eigen::VectorXd FromErrors(const Eigen::VectorXd& delta) const;

  void Evaluate(const Eigen::VectorXd& x, bool with_jacobians) override;
  void Residual(int block, Eigen::Map<Eigen::VectorXd> residual) const override;
  void Jacobian(int block, int k, Eigen::Map<RowMajorMatrix> jacobian) const override;

 private:
  struct Observation {
    int posture, marker;
  };
  /// Where the columns of one parameter block stand in a marker's block of the Jacobian.
  struct BlockColumns {
    int block;
    std::vector<int> source;  // column in GeneralizedJacobian::Block
    Eigen::RowVectorXd scale;
  };

  void MakeParameterBlocks(const std::vector<int>& free, const Prior& prior);
  void MakeResidualBlocks(const ObservationMask& mask, const Prior& prior);

  const ErrorModel& model_;
  const Recording& recording_;
  Eigen::VectorXd fixed_;
  double marker_sd_;
  std::vector<int> free_;      // by unknown: parameter
  Eigen::VectorXd scale_;      // by unknown
  std::vector<int> block_of_;  // by unknown
  GeneralizedJacobian jacobian_;
  std::vector<std::vector<BlockColumns>> marker_columns_;  // by marker
  std::vector<Observation> observations_;
  std::vector<int> prior_unknowns_;  // by prior residual block
  Eigen::VectorXd x_;
  Eigen::Matrix3Xd residuals_;             // by observation
  std::vector<RowMajorMatrix> jacobians_;  // by observation
};

}  // namespace elastocal
