#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/body_unknowns.hpp"
#include "elastocal/calibration/loads.hpp"
#include "elastocal/calibration/noise.hpp"
#include "elastocal/calibration/support_tie.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/optim/least_squares.hpp"
#include "elastocal/robot/jacobian.hpp"

namespace elastocal {

/// postures x markers: which observations take part.
using ObservationMask = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>;

/// Observations that are there at all.
ObservationMask SeenMask(const Recording& recording);

/// What the residuals are made from; keeps references.
struct ResidualInputs {
  const ErrorModel& model;
  const Recording& recording;
  const std::vector<int>& group;           ///< of each posture, see NoiseGroups
  const ObservationMask& used;             ///< markers that take part
  const std::vector<char>& tied;           ///< postures whose support constraint takes part
  const std::vector<PostureLoads>& loads;  ///< by posture; empty: nothing is elastic
  const Prior& prior;
  const Noise& noise;
  SupportForm form = SupportForm::kNuisance;
};

/// Eq. 14 as a least-squares problem: for every observation the difference between measured and
/// predicted marker position (those on the foot that stands: from the footing, the others from the
/// waist); for every posture on one foot what its constraint leaves (see
/// support_tie.hpp); for every parameter with a prior its deviation from nominal; each over its
/// standard deviation.
///
/// The unknowns are those of BodyUnknowns. An observation meets one waist (one marker in a table of
/// postures, which has no such waists), so that these are eliminated first.
class BodyResiduals : public LeastSquaresProblem {
 public:
  /// `free`: indices of the estimated parameters, ascending; all others stay as in `delta` (one
  /// value a parameter). The inputs' referents and `placement` must outlive it.
  BodyResiduals(const ResidualInputs& inputs, const std::vector<int>& free,
                const Eigen::VectorXd& delta, const Placement& placement);

  static constexpr double kPoseScale = BodyUnknowns::kPoseScale;
  /// See BodyUnknowns.
  Eigen::VectorXd Start() const { return unknowns_.Start(); }
  Eigen::VectorXd ToErrors(const Eigen::VectorXd& x) const { return unknowns_.ToErrors(x); }
  Placement ToPlacement(const Eigen::VectorXd& x) const { return unknowns_.ToPlacement(x); }
  std::vector<int> WaistBlocks() const { return unknowns_.WaistBlocks(); }

  /// What a residual block is about. Marker observations come first, then ties, then priors.
  struct Meaning {
    int posture = -1;
    int marker = -1;  ///< -1: the tie of the posture
  };
  /// By residual block; priors have none.
  const std::vector<Meaning>& meanings() const { return meanings_; }

  void Evaluate(const Eigen::VectorXd& x, bool with_jacobians) override;
  void Residual(int block, Eigen::Map<Eigen::VectorXd> residual) const override;
  void Jacobian(int block, int k, Eigen::Map<RowMajorMatrix> jacobian) const override;

 private:
  void MakeMarkerBlocks();
  void MakeTieBlocks();
  void MakePriorBlocks();
  double MarkerSd(int posture, int marker) const;
  /// Whether the marker is on the foot that the posture stands on.
  bool OnStandingFoot(int posture, int marker) const;
  void EvaluateMarker(int block, int posture, int marker);
  void EvaluateFootMarker(int block, int posture, int marker);
  void EvaluateTieBlock(int block, int posture);
  void FillTieJacobian(int leg, const PostureLoads& load, const Vector6d& wrench,
                       const TieResidual& at, RowMajorMatrix& J) const;

  ResidualInputs in_;
  const Placement& placement_;
  BodyUnknowns unknowns_;
  GeneralizedJacobian jacobian_;
  std::vector<std::vector<BodyUnknowns::Columns>> marker_columns_;  // by marker
  std::vector<std::vector<BodyUnknowns::Columns>> leg_columns_;     // by leg
  std::vector<BodyUnknowns::Deflection> deflections_;               // by leg
  std::vector<Meaning> meanings_;
  std::vector<std::vector<int>> blocks_of_posture_;
  std::vector<int> prior_unknowns_;  // by prior residual block
  Eigen::VectorXd x_;
  Geometry geometry_;
  std::vector<Eigen::VectorXd> residuals_;  // by block, priors aside
  std::vector<RowMajorMatrix> jacobians_;   // as they are met, side by side
};

}  // namespace elastocal
