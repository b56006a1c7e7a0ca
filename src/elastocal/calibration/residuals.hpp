// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/body_unknowns.hpp"
#include "elastocal/calibration/loads.hpp"
#include "elastocal/calibration/noise.hpp"
#include "elastocal/calibration/observations.hpp"
#include "elastocal/calibration/support_tie.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/optim/least_squares.hpp"
#include "elastocal/robot/jacobian.hpp"

namespace elastocal {

/// Weight of a body in a posture, or of a posture's support constraint: 1, or less where it is
/// further off than the noise explains (a likelihood with heavy tails).
struct Weight {
  double shared = 1.0;  ///< weight of what all markers of the body share, or of a constraint
  double own = 1.0;     ///< weight of the markers' own residuals, beside what they share
};

struct RobustWeights {
  std::vector<Weight> bodies;  ///< by Selection::bodies; empty: all 1
  std::vector<double> ties;    ///< by posture; empty: all 1
};

/// Inputs of the residuals; keeps references.
struct ResidualInputs {
  const ErrorModel& model;
  const Recording& recording;
  const std::vector<int>& group;  ///< noise group of each posture, see NoiseGroups
  const Selection& selection;
  const std::vector<PostureLoads>& loads;  ///< by posture; empty: nothing is elastic
  const Prior& prior;
  const Noise& noise;
  const RobustWeights& weights;
  const CalibrationOptions& options;
};

/// Eq. 14 as a least-squares problem. Each residual is divided by its standard deviation:
///
/// - for every body in every posture: measured minus predicted positions of its markers, in the
///   basis of BodyObservation (markers on the standing foot are predicted from the footing, the
///   others from the waist);
/// - for every posture on one foot: the residual of its support constraint (support_tie.hpp);
/// - for every footing on a leg: the deviation of its sole from the floor (floor.hpp);
/// - for every parameter: its deviation from nominal, or for all parameters of an earlier estimate
///   together their deviation from that;
/// - for every footing: its displacement, with a vague prior (1 m and 1 rad).
///
/// The unknowns are those of BodyUnknowns. A body in a posture depends on one waist at most (in a
/// posture table on none), so that the poses of the waist are eliminated first.
class BodyResiduals : public LeastSquaresProblem {
 public:
  /// `free` holds the indices of the estimated parameters, ascending; all others keep their value
  /// in `delta` (one value a parameter). What the inputs refer to, and `placement`, must outlive
  /// the object.
  BodyResiduals(const ResidualInputs& inputs, const std::vector<int>& free,
                const Eigen::VectorXd& delta, const Placement& placement);

  static constexpr double kPoseScale = BodyUnknowns::kPoseScale;
  /// Tells that the loads in the inputs were computed for the solution `x`. (At first they are
  /// those of the errors given.)
  void LoadsFollow(const Eigen::VectorXd& x) {
    loaded_geometry_ = ApplyErrors(in_.model, unknowns_.ToErrors(x));
  }

  /// See BodyUnknowns.
  Eigen::VectorXd Start() const { return unknowns_.Start(); }
  Eigen::VectorXd ToErrors(const Eigen::VectorXd& x) const { return unknowns_.ToErrors(x); }
  Placement ToPlacement(const Eigen::VectorXd& x) const { return unknowns_.ToPlacement(x); }

  /// Order of the residual blocks: the bodies of the selection, the support constraints, the floor,
  /// the priors, and last the prior of an earlier estimate.
  int body_count() const { return static_cast<int>(in_.selection.bodies.size()); }
  const std::vector<int>& tied_postures() const { return tied_postures_; }
  int TieBlock(int tie) const { return body_count() + tie; }

  /// Number of postures for which one body or constraint counts, by row. It is 1, or less for a
  /// moment of a motion, whose neighbours share the model's errors with it (Noise::motion); the
  /// noise of single markers is not shared. Standard deviations are larger by the root of its
  /// inverse.
  Eigen::ArrayXd Counts(int block) const;

  /// Expresses displacements of a body's markers (columns of `displacement`, 3 markers x any, m) as
  /// rows of its residual block, in units of their standard deviations.
  Eigen::MatrixXd Whiten(int body, const Eigen::MatrixXd& displacement) const;
  /// Standard deviations of a residual block's rows: of a body in its basis, m; of a constraint, m
  /// and rad.
  const Eigen::VectorXd& Sds(int block) const { return sds_[block]; }

  void Evaluate(const Eigen::VectorXd& x, bool with_jacobians) override;
  const Eigen::VectorXd& Residual(int block) const override { return residuals_[block]; }
  const RowMajorMatrix& Jacobian(int block) const override { return jacobians_[block]; }

 private:
  void MakeBodyBlock(const BodyObservation& body);
  void MakeTieBlocks();
  void MakeFloorBlocks();
  void MakePriorBlocks();
  void MakeEarlierBlock(const EarlierPart& earlier);
  JointLoads LoadsNow(int posture) const {
    if (in_.loads.empty()) return {};
    return TurnedLoads(in_.model, loaded_geometry_, geometry_, in_.loads[posture].joints);
  }
  Eigen::VectorXd BodySds(std::size_t body) const;
  Vector6d TieSds(int posture) const;
  /// Number of moments that tell as much as one posture, by the correlation of bodies or of the
  /// waist; 1 where the posture belongs to no motion.
  double SamplesEach(int posture, Autocorrelation MotionCorrelation::*of) const;
  /// Whether the body is the foot that the posture stands on.
  bool IsStandingFoot(int posture, int body) const;
  void EvaluateBody(int block, bool with_jacobians);
  void EvaluateFoot(int block, bool with_jacobians);
  void EvaluateTie(int block, int posture);
  void EvaluateFloors();
  void FillTieJacobian(int leg, const PostureLoads& load, const Vector6d& wrench,
                       const TieResidual& at, RowMajorMatrix& J) const;

  ResidualInputs in_;
  const Placement& placement_;
  BodyUnknowns unknowns_;
  GeneralizedJacobian jacobian_;
  std::vector<int> motion_;  // motion of each posture; -1: none
  std::vector<std::vector<BodyUnknowns::Columns>> marker_columns_;  // by marker
  std::vector<std::vector<BodyUnknowns::Columns>> leg_columns_;     // by leg
  std::vector<BodyUnknowns::Deflection> deflections_;               // by leg
  std::vector<int> tied_postures_;
  std::vector<int> floor_footings_;
  std::vector<std::vector<int>> blocks_of_posture_;
  std::vector<int> prior_unknowns_;    // by block of a prior: its first entry of x
  std::vector<double> prior_weights_;  // by block of a prior: weight of its entries
  // entries of x in the block of the earlier estimate; empty: there is none
  std::vector<int> earlier_entries_;
  Eigen::VectorXd earlier_offset_;
  Eigen::VectorXd x_;
  Geometry geometry_, loaded_geometry_;  // at x; at the solution for which the loads were computed
  std::vector<Eigen::VectorXd> sds_;     // by block, without the priors
  std::vector<Eigen::VectorXd> residuals_;
  std::vector<RowMajorMatrix> jacobians_;
  Eigen::VectorXd raw_;  // residuals of the body being evaluated, m
  Eigen::MatrixXd raw_jacobian_;
};

}  // namespace elastocal
