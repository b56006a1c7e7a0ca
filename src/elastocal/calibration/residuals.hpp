#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/loads.hpp"
#include "elastocal/calibration/noise.hpp"
#include "elastocal/calibration/options.hpp"
#include "elastocal/calibration/placement.hpp"
#include "elastocal/calibration/support_tie.hpp"
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
/// The unknowns are the free parameters in units of ParameterScale, in blocks: T0, each joint, each
/// leg, each marker; then, of trials, the pose of each footing and that of the waist in each
/// posture, as displacements from where they were. An observation meets one waist (one marker in a
/// table of postures, which has no such waists), so that these are eliminated first.
class BodyResiduals : public LeastSquaresProblem {
 public:
  static constexpr double kPoseScale = 0.01;  ///< of poses in the solver, m and rad

  /// `free`: indices of the estimated parameters, ascending; all others stay as in `delta` (one
  /// value a parameter). The inputs' referents and `placement` must outlive it.
  BodyResiduals(const ResidualInputs& inputs, const std::vector<int>& free,
                const Eigen::VectorXd& delta, const Placement& placement);

  /// Where the solver starts: at `delta` and `placement`.
  Eigen::VectorXd Start() const;
  Eigen::VectorXd ToErrors(const Eigen::VectorXd& x) const;
  Placement ToPlacement(const Eigen::VectorXd& x) const;

  /// Blocks of x that hold the waists' poses.
  std::vector<int> WaistBlocks() const;

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
  /// Columns of one parameter block in what is evaluated for a marker or a leg.
  struct BlockColumns {
    int block;                // kWaistBlock: the posture's own
    std::vector<int> source;  // columns of GeneralizedJacobian
    Eigen::RowVectorXd scale;
  };
  /// Unknowns that act on a tie through the deflection of the leg.
  struct Deflection {
    int block = -1;
    std::vector<int> parameters;
    Eigen::RowVectorXd scale;
  };

  void MakeParameterBlocks(const std::vector<int>& free);
  void MakePoseBlocks();
  std::vector<BlockColumns> MapColumns(const std::vector<int>& columns) const;
  Deflection MapDeflection(int leg) const;
  bool IsMarkerBlock(int block) const;
  void MakeMarkerBlocks();
  void MakeTieBlocks();
  void MakePriorBlocks();
  double MarkerSd(int posture, int marker) const;
  Vector6d PoseAt(int block) const;
  /// Whether the marker is on the foot that the posture stands on.
  bool OnStandingFoot(int posture, int marker) const;
  Transform FootingPose(const Eigen::VectorXd& x, int footing) const;
  /// Derivative of a footing's motion, in its own axes, by its unknowns.
  Matrix6d FootingChart(int footing) const;
  void EvaluateMarker(int block, int posture, int marker);
  void EvaluateFootMarker(int block, int posture, int marker);
  void EvaluateTieBlock(int block, int posture);
  void FillTieJacobian(int leg, const PostureLoads& load, const Vector6d& wrench,
                       const TieResidual& at, RowMajorMatrix& J) const;

  ResidualInputs in_;
  Eigen::VectorXd fixed_;
  const Placement& placement_;
  std::vector<int> free_;         // by unknown parameter
  Eigen::VectorXd scale_;         // by unknown parameter
  std::vector<int> block_of_;     // by unknown parameter
  std::vector<int> first_entry_;  // by parameter block: in x
  int first_footing_block_ = 0, first_waist_block_ = 0;
  GeneralizedJacobian jacobian_;
  std::vector<std::vector<BlockColumns>> marker_columns_;  // by marker
  std::vector<std::vector<BlockColumns>> leg_columns_;     // by leg
  std::vector<Deflection> deflections_;                    // by leg
  std::vector<Meaning> meanings_;
  std::vector<std::vector<int>> blocks_of_posture_;
  std::vector<int> prior_unknowns_;  // by prior residual block
  Eigen::VectorXd x_, delta_;
  Geometry geometry_;
  std::vector<Eigen::VectorXd> residuals_;  // by block, priors aside
  std::vector<RowMajorMatrix> jacobians_;   // as they are met, side by side
};

}  // namespace elastocal
