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

/// Result of a calibration with one kind of model.
struct CalibrationResult {
  ModelKind kind = ModelKind::kGeometric;
  /// The error model with the nominal pose of the waist that T0 deviates from (found by
  /// registration), in the reference frame of the recording.
  ErrorModel model;
  Eigen::VectorXd delta;    ///< errors, one a parameter of `model`; SI units
  Gauge gauge;              ///< rule that chose where the root link's frame is
  Placement placement;      ///< poses of the waist and of the footings; empty for a posture table
  std::vector<Slip> slips;  ///< feet (or a held root link) that were displaced within a trial
  std::vector<ParameterStatus> status;  ///< one a parameter
  /// Posterior standard deviation, one a parameter; NaN where none applies.
  Eigen::VectorXd sd;
  /// Standard deviation of the (widened) prior, one a parameter; NaN where none applies.
  Eigen::VectorXd prior_sd;
  /// Half width of a 95 % interval in standard deviations (Student's t; normal where the noise is
  /// given).
  double interval_factor = 1.96;
  Posterior posterior;  ///< posterior of the estimated and unsupported parameters
  std::vector<Correlation> correlations;

  ObservationMask used;           ///< observations that took part in the fit
  std::vector<Outlier> outliers;  ///< observations that were judged outliers, with the reason
  /// Without the outliers there were too few equations, so that all took part.
  bool too_many_outliers = false;
  std::vector<char> tied;  ///< postures whose support constraint took part
  /// Postures on one foot whose support constraint did not hold, with the reason.
  std::vector<LooseFooting> loose_footings;
  std::vector<ShortModel> short_models;  ///< bodies that count less than 1, the furthest off first
  LoadReport loads;        ///< loads that were computed by statics because they were not measured
  std::vector<int> group;  ///< noise group of each posture
  Noise noise;             ///< standard deviations by group; estimated unless given
  /// Standard deviation of one coordinate of a marker, m: root mean square, over the used
  /// observations, of the noise of single markers and the shared displacement of a body together.
  /// The noise that all markers of a posture share through the waist is not part of it.
  double marker_sd = 0.0;
  PriorScale prior_scale;  ///< factors by which the prior was widened
  int equations = 0;       ///< three for each used observation

  /// How the last solve ended. `settled`: noise, prior and the verdict on outliers came to rest.
  Termination termination = Termination::kFailure;
  bool settled = true;
  std::string message;
  int iterations = 0;                           ///< sum over all solves
  double initial_cost = 0.0, final_cost = 0.0;  ///< cost at start and end of the last solve
  double solve_seconds = 0.0;
};

/// Estimates the parameters of one kind of model from a recording (paper section 5):
///
/// 1. The waist is placed by registration (in trials: in each posture). Then only waist and marker
///    positions are fitted.
/// 2. All parameters of the kind are fitted, with the noise estimated by medians. Outliers are
///    named and left out (FindOutliers), unless too few equations would be left.
/// 3. All parameters are fitted to the rest by least squares with a Gaussian prior. The sources of
///    noise (NoiseSource) are estimated from the residuals, and the factors that widen the prior
///    from the estimates. A body that is further off than the noise explains counts less.
///
/// Step 3 is repeated until the verdict on outliers no longer changes. All parameters are estimated
/// together, also those that cannot be told from others: the prior makes the result unique, and it
/// changes continuously with the nominal geometry. All trials are estimated together (eq. 14, see
/// BodyResiduals).
///
/// `base` says which parameters are held, and how many can be identified. If `fixed` is given,
/// exactly its observations and constraints are used, and no outliers are looked for. Throws
/// InputError when there are fewer equations than parameters. `termination` tells whether the
/// solver converged.
CalibrationResult Calibrate(const ErrorModel& model, const Recording& recording,
                            const BaseParameters& base, ModelKind kind,
                            const CalibrationOptions& options, const Selection* fixed = nullptr);

/// Fits only waist and marker positions to a recording. The joints' errors stay as given by
/// parameter name [rad or m]. This applies a calibration to a recording of another day. Names that
/// are no parameter of the model are ignored. The result is of kind kUncalibrated; its `delta`
/// contains the joints' errors. In long motions, a part of the moments determines noise and
/// markers; all moments then correct both, and are judged. `iterations` counts both fits, and
/// `settled` is of the verdict on outliers among all moments.
CalibrationResult RefitExternals(const ErrorModel& model, const Recording& recording,
                                 const BaseParameters& base, const CalibrationOptions& options,
                                 const std::map<std::string, double>& joint_errors,
                                 const Selection* fixed = nullptr);

/// Removes the springs from a full model: keeps its geometry and fits waist and markers anew to the
/// observations in `fixed`. The result shows what the estimate is worth as a URDF. Its kind is
/// kRigid.
CalibrationResult WithoutSprings(const CalibrationResult& full, const ErrorModel& model,
                                 const Recording& recording, const BaseParameters& base,
                                 const CalibrationOptions& options, const Selection& fixed);

/// Whether a parameter has the status estimated and differs from nominal by more than its 95 %
/// interval.
bool Significant(const CalibrationResult& result, int parameter);

}  // namespace elastocal
