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

/// How much a body in a posture, or a posture's support constraint, counts: 1, or less where it is
/// further off than the noise explains (a likelihood with heavy tails).
struct Weight {
  double shared = 1.0;  ///< of what the markers share; of a constraint
  double own = 1.0;     ///< of what is left of each marker
};

struct RobustWeights {
  std::vector<Weight> bodies;  ///< by Selection::bodies; empty: all 1
  std::vector<double> ties;    ///< by posture; empty: all 1
};

/// What the residuals are made from; keeps references.
struct ResidualInputs {
  const ErrorModel& model;
  const Recording& recording;
  const std::vector<int>& group;  ///< of each posture, see NoiseGroups
  const Selection& selection;
  const std::vector<PostureLoads>& loads;  ///< by posture; empty: nothing is elastic
  const Prior& prior;
  const Noise& noise;
  const RobustWeights& weights;
  const CalibrationOptions& options;
};

/// Eq. 14 as a least-squares problem: for the markers of every body in every posture the difference
/// between measured and predicted positions (those on the foot that stands: from the footing, the
/// others from the waist), in the basis of BodyObservation; for every posture on one foot what its
/// constraint leaves (see support_tie.hpp); for every footing on a leg how far its sole is from
/// flat on the floor (floor.hpp); for every parameter its deviation from nominal, or together
/// that from an earlier estimate; for every footing (vaguely, 1 m and 1 rad) its displacement; each
/// over its standard deviation.
///
/// The unknowns are those of BodyUnknowns. A body in a posture meets one waist (in a table of
/// postures none), so that these are eliminated first.
class BodyResiduals : public LeastSquaresProblem {
 public:
  /// `free`: indices of the estimated parameters, ascending; all others stay as in `delta` (one
  /// value a parameter). The inputs' referents and `placement` must outlive it.
  BodyResiduals(const ResidualInputs& inputs, const std::vector<int>& free,
                const Eigen::VectorXd& delta, const Placement& placement);

  static constexpr double kPoseScale = BodyUnknowns::kPoseScale;
  /// The loads now follow the solution `x`. (At first they are those of the errors given.)
  void LoadsFollow(const Eigen::VectorXd& x) {
    loaded_geometry_ = ApplyErrors(in_.model, unknowns_.ToErrors(x));
  }

  /// See BodyUnknowns.
  Eigen::VectorXd Start() const { return unknowns_.Start(); }
  Eigen::VectorXd ToErrors(const Eigen::VectorXd& x) const { return unknowns_.ToErrors(x); }
  Placement ToPlacement(const Eigen::VectorXd& x) const { return unknowns_.ToPlacement(x); }

  /// Residual blocks: first the bodies of the selection, then the constraints, then those
  /// of the floor, then the priors, that of an earlier estimate last.
  int body_count() const { return static_cast<int>(in_.selection.bodies.size()); }
  const std::vector<int>& tied_postures() const { return tied_postures_; }
  int TieBlock(int tie) const { return body_count() + tie; }

  /// As how many postures the one of a body or constraint counts, by row: 1, or less where it is a
  /// moment of a motion, whose neighbours share their model error with it (Noise::motion); noise of
  /// single markers they do not share. Standard deviations are larger by the root of its inverse.
  Eigen::ArrayXd Counts(int block) const;

  /// Rows in units of the residual's standard deviation of what would displace the markers of a
  /// body by the columns of `displacement` (3 markers x any, m).
  Eigen::MatrixXd Whiten(int body, const Eigen::MatrixXd& displacement) const;
  /// Standard deviations of a residual block's rows: in the basis of the body, m; of a constraint,
  /// m and rad.
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
  /// How many moments like this one tell as much as one posture, by the correlation of bodies or of
  /// the waist; 1 of other postures.
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
  std::vector<int> motion_;                                         // of each posture
  std::vector<std::vector<BodyUnknowns::Columns>> marker_columns_;  // by marker
  std::vector<std::vector<BodyUnknowns::Columns>> leg_columns_;     // by leg
  std::vector<BodyUnknowns::Deflection> deflections_;               // by leg
  std::vector<int> tied_postures_;
  std::vector<int> floor_footings_;
  std::vector<std::vector<int>> blocks_of_posture_;
  std::vector<int> prior_unknowns_;    // by prior residual block: its first entry of x
  std::vector<double> prior_weights_;  // likewise: of the entries
  std::vector<int> earlier_entries_;   // of x, of the last block; empty: there is no such block
  Eigen::VectorXd earlier_offset_;
  Eigen::VectorXd x_;
  Geometry geometry_, loaded_geometry_;  // now, and with which the loads were found
  std::vector<Eigen::VectorXd> sds_;     // by block, priors aside
  std::vector<Eigen::VectorXd> residuals_;
  std::vector<RowMajorMatrix> jacobians_;
  Eigen::VectorXd raw_;  // of the body in hand, m
  Eigen::MatrixXd raw_jacobian_;
};

}  // namespace elastocal
