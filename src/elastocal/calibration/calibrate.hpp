// SPDX-License-Identifier: Apache-2.0
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
  kGeometric,     ///< all geometric parameters (GCM)
  kRigid,         ///< the geometry of kFull without its springs: what a URDF can carry of it
  kFull,          ///< geometric and elastic ones (FCM)
};

inline constexpr int kModelKindCount = 5;

/// uncalibrated, offsets_only, geometric, rigid, full
const char* ModelKindName(ModelKind kind);

/// The kinds that mean something for a model: all, or the first three where nothing is elastic.
std::vector<ModelKind> ModelKinds(const ErrorModel& model);

/// What became of a parameter.
enum class ParameterStatus {
  kEstimated,
  /// The data tell hardly more than the prior, or tell it only together with others: the value is
  /// the most probable one.
  kUnsupported,
  kHeld,        ///< held at nominal by the user's setting
  kNotInModel,  ///< not of the kinds that this ModelKind estimates
};

/// estimated, unsupported, held, not_in_model
const char* StatusName(ParameterStatus status);

struct CalibrationResult {
  ModelKind kind = ModelKind::kGeometric;
  /// The error model with the nominal pose of the waist that T0 deviates from (found by
  /// registration), in the reference frame of the recording.
  ErrorModel model;
  Eigen::VectorXd delta;                ///< errors, one a parameter of `model`; SI units
  Gauge gauge;                          ///< who says where the root link's frame is
  Placement placement;                  ///< where the robot stood; empty for a table of postures
  std::vector<Slip> slips;              ///< of feet
  std::vector<ParameterStatus> status;  ///< one a parameter
  /// Posterior standard deviation, one a parameter; NaN where none applies.
  Eigen::VectorXd sd;
  /// That of the prior, as wide as it came out; NaN where none applies.
  Eigen::VectorXd prior_sd;
  /// Half width of a 95 % interval in standard deviations (Student's t; normal where the noise is
  /// given).
  double interval_factor = 1.96;
  Posterior posterior;  ///< of estimated and unsupported parameters
  std::vector<Correlation> correlations;

  ObservationMask used;                      ///< observations that took part
  std::vector<Outlier> outliers;             ///< those that did not, and why
  bool too_many_outliers = false;            ///< without them, too few equations: they took part
  std::vector<char> tied;                    ///< postures whose support constraint took part
  std::vector<LooseFooting> loose_footings;  ///< those on one foot whose did not, and why
  std::vector<ShortModel> short_models;      ///< bodies that count less, the furthest off first
  LoadReport loads;                          ///< loads that were not measured
  std::vector<int> group;                    ///< noise group of each posture
  Noise noise;                               ///< by group; estimated unless given
  /// Standard deviation of one coordinate of a marker, over all groups, m: noise of the cameras and
  /// displacement of the body, without what all markers of a posture share through the waist.
  double marker_sd = 0.0;
  PriorScale prior_scale;  ///< factors by which the prior was widened
  int equations = 0;       ///< 3 a used observation

  /// How the last solve ended, and whether noise, prior and the verdict on outliers came to rest.
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
/// 2. all parameters of the kind, with the noise by medians; measurements gone wrong are named and
///    left out (FindOutliers), unless too few equations would be left;
/// 3. least squares with Gaussian prior on the rest. The sources of noise (NoiseSource) follow from
///    the residuals, the factors that widen the prior from the estimates, and a body that is
///    further off than the noise explains counts less.
///
/// Step 3 is repeated until the verdict on outliers stands. All parameters are estimated together,
/// also those that cannot be told from others: the prior makes the result unique, and it changes
/// continuously with the nominal geometry.
///
/// `base`: which parameters are held, and how many could be identified. `fixed`, where given, says
/// which observations and constraints to use, instead of looking for outliers.
/// All trials are estimated together (eq. 14, see BodyResiduals).
/// Throws InputError when there are fewer equations than parameters. Non-convergence is told by
/// `termination`.
CalibrationResult Calibrate(const ErrorModel& model, const Recording& recording,
                            const BaseParameters& base, ModelKind kind,
                            const CalibrationOptions& options, const Selection* fixed = nullptr);

/// Fits only waist and marker positions to a recording, the joints' errors being given by name
/// [rad or m]: what it takes to use a calibration on another day. Names of joints that move no
/// marker of this recording are passed over. Result of kind kUncalibrated with the joints' errors
/// in `delta`. Of long motions, a part of the moments tells noise and markers; all of them then
/// correct both, and are judged.
CalibrationResult RefitExternals(const ErrorModel& model, const Recording& recording,
                                 const BaseParameters& base, const CalibrationOptions& options,
                                 const std::map<std::string, double>& joint_errors,
                                 const Selection* fixed = nullptr);

/// The geometry of a full model without its springs, waist and markers refitted to the observations
/// in `fixed`: what is left when the estimate is used as a URDF. Its kind is kRigid.
CalibrationResult WithoutSprings(const CalibrationResult& full, const ErrorModel& model,
                                 const Recording& recording, const BaseParameters& base,
                                 const CalibrationOptions& options, const Selection& fixed);

/// Whether an estimated parameter differs from nominal by more than its 95 % interval.
bool Significant(const CalibrationResult& result, int parameter);

}  // namespace elastocal
