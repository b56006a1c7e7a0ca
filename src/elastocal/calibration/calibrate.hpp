#pragma once

#include <map>
#include <string>
#include <vector>

#include "elastocal/calibration/options.hpp"
#include "elastocal/calibration/outliers.hpp"
#include "elastocal/calibration/posterior.hpp"
#include "elastocal/identifiability/base_parameters.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/optim/least_squares.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Which parameters are estimated, the others being nominal (paper section 6.1.4).
enum class ModelKind {
  kUncalibrated,  ///< waist and marker positions only (NCM)
  kOffsetsOnly,   ///< and joint offsets theta
  kGeometric,     ///< all identifiable geometric parameters (GCM)
  kFull,          ///< and the elastic ones (FCM)
};

inline constexpr int kModelKindCount = 4;

/// uncalibrated, offsets_only, geometric, full
const char* ModelKindName(ModelKind kind);

/// The kinds that mean something for a model: all, or all but kFull where nothing is elastic.
std::vector<ModelKind> ModelKinds(const ErrorModel& model);

/// What became of a parameter.
enum class ParameterStatus {
  kEstimated,
  kUnsupported,  ///< the data hardly tell more than the prior: held at nominal
  kDropped,      ///< not identifiable beside others, into which it is regrouped
  kHeld,         ///< held at nominal by the user's setting
  kNotInModel,   ///< not of the kinds that this ModelKind estimates
};

/// estimated, unsupported, dropped, held, not_in_model
const char* StatusName(ParameterStatus status);

struct CalibrationResult {
  ModelKind kind = ModelKind::kGeometric;
  /// The error model with the nominal pose of the waist that T0 deviates from (found by
  /// registration), in the reference frame of the recording.
  ErrorModel model;
  Eigen::VectorXd delta;                ///< errors, one a parameter of `model`; SI units
  Placement placement;                  ///< where the robot stood; empty for a table of postures
  std::vector<Slip> slips;              ///< of feet
  std::vector<ParameterStatus> status;  ///< one a parameter
  /// Posterior standard deviation, one a parameter; for an unsupported one it says how little is
  /// known; NaN where none applies.
  Eigen::VectorXd sd;
  /// Half width of a 95 % interval in standard deviations (Student's t; normal where the noise is
  /// given).
  double interval_factor = 1.96;
  Posterior posterior;  ///< of estimated and unsupported parameters together
  std::vector<Correlation> correlations;

  ObservationMask used;                      ///< observations that took part
  std::vector<Outlier> outliers;             ///< those that did not, and why
  std::vector<char> tied;                    ///< postures whose support constraint took part
  std::vector<LooseFooting> loose_footings;  ///< those on one foot whose did not, and why
  LoadReport loads;                          ///< loads that were not measured
  std::vector<int> group;                    ///< noise group of each posture
  Noise noise;                               ///< by group; estimated unless given
  double marker_sd = 0.0;                    ///< of one coordinate, over all groups, m
  PriorScale prior_scale;                    ///< factors by which the prior was widened
  int equations = 0;                         ///< 3 a used observation

  /// Of the last solve; and whether noise, prior and the verdict on outliers came to rest.
  Termination termination = Termination::kFailure;
  bool settled = true;
  std::string message;
  int iterations = 0;                           ///< of all solves together
  double initial_cost = 0.0, final_cost = 0.0;  ///< of the last solve
  double solve_seconds = 0.0;
};

/// Estimates the parameters of one kind of model from a recording (paper section 5):
///
/// 1. waist pose by registration (of trials: in each posture), then waist and marker positions
/// alone;
/// 2. all parameters of the kind under Cauchy's loss; observations beyond what noise and
///    uncertainty explain are named outliers and left out;
/// 3. least squares with Gaussian prior on the rest; the noise of a marker coordinate (unless it is
///    given) follows from the residuals, and the factors that widen the prior from the estimates;
/// 4. parameters that the data do not support are held at nominal, and the others estimated again.
///    Their uncertainty is still counted in that of the others.
///
/// Steps 3 and 4 are repeated until the verdict on outliers stands.
///
/// `base` holds the identifiable parameters of `model` for this kind. `fixed`, where given, says
/// which observations and constraints to use, instead of looking for outliers.
/// Of trials, all are estimated together (eq. 14): see BodyResiduals.
/// Throws InputError when there are fewer equations than parameters. Non-convergence is told by
/// `termination`.
CalibrationResult Calibrate(const ErrorModel& model, const Recording& recording,
                            const BaseParameters& base, ModelKind kind,
                            const CalibrationOptions& options, const Selection* fixed = nullptr);

/// Fits only waist and marker positions to a recording, the joints' errors being given by name
/// [rad or m]: what it takes to use a calibration on another day. Names of joints that move no
/// marker of this recording are passed over. Result of kind kUncalibrated with the joints' errors
/// in `delta`.
CalibrationResult RefitExternals(const ErrorModel& model, const Recording& recording,
                                 const BaseParameters& base, const CalibrationOptions& options,
                                 const std::map<std::string, double>& joint_errors,
                                 const Selection* fixed = nullptr);

/// Whether an estimated parameter differs from nominal by more than its 95 % interval.
bool Significant(const CalibrationResult& result, int parameter);

}  // namespace elastocal
