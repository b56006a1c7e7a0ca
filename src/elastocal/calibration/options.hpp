// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "elastocal/calibration/earlier.hpp"
#include "elastocal/robot/parameters.hpp"
#include "elastocal/robot/posture_loads.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Kinds of parameters whose prior is widened together.
enum class PriorGroup {
  kAngles,
  kLengths,
  kTorsion,
  kBending,
  kLegForce,
  kLegMoment,
  kTorqueBias,
  kCorrections
};
inline constexpr int kPriorGroupCount = 8;

/// angles, lengths, torsion, bending, base_force, base_moment, torque_bias, corrections
const char* PriorGroupName(PriorGroup group);

/// The group of a joint's or leg's parameter.
PriorGroup GroupOf(ParameterKind kind);

/// The prior of a group is widened no further than this. For geometry 10: what lies beyond is no
/// error of a robot. For springs 100: they differ from robot to robot by far more.
double MostWidening(PriorGroup group);

/// Factors by which a prior is widened, by group.
struct PriorScale {
  std::array<double, kPriorGroupCount> factor;

  PriorScale() { factor.fill(1.0); }
  double& operator[](PriorGroup group) { return factor[static_cast<int>(group)]; }
  double operator[](PriorGroup group) const { return factor[static_cast<int>(group)]; }
};

/// Standard deviation of the Gaussian prior on each kind of parameter, around nominal, in the
/// parameter's SI unit. All parameters have one, so that all can be estimated together: what the
/// data do not tell apart is shared out as the priors say. docs/formats.md gives the reasons.
struct Prior {
  /// By kind. 0.5 degrees and 1 mm on joints; 1 rad and 1 m on T0 and markers, about which nobody
  /// knows anything beforehand; legs about an axis 5e-5 rad/(N.m), along an axis 1e-5 m/N; torque
  /// sensors 2 N.m. Torsion and bending 0: by `deflection`.
  std::array<double, kParameterKindCount> sd;
  /// How far a revolute joint gives way, about and across its axis, under its largest torque (the
  /// URDF's effort), rad: strong joints are stiff. Corrections: as they say themselves.
  double deflection = 0.01;
  PriorScale scale = {};  ///< by which all are multiplied

  Prior();
  double& operator[](ParameterKind kind) { return sd[static_cast<int>(kind)]; }
  double operator[](ParameterKind kind) const { return sd[static_cast<int>(kind)]; }

  /// That of a parameter of the robot, widened; never more than what counts as unknown.
  double Of(const RobotTree& tree, const Parameter& parameter) const;
};

/// Unit of each parameter in the solver: of similar influence whatever the parameter. 0.5 degrees,
/// 1 mm, 5e-5 rad/(N.m), ...; of T0 and markers 0.01 (m or rad).
double ParameterScale(const Parameter& parameter);

/// How the support foot's constraint (eq. 14) enters.
enum class SupportForm {
  /// The waist of each posture is unknown: tied to the foot by the elastic leg within what that
  /// model leaves unexplained (estimated), and seen by its markers and those it carries.
  kNuisance,
  /// The leg is taken as exact: everything hangs on the foot.
  kFootRooted,
};

/// What happens to outliers.
enum class OutlierPolicy {
  kRemove,  ///< they are named and left out
  kKeep,    ///< they are named and kept, at the weight that heavy tails give them
};

/// Who says where the root link's frame is, which no measurement tells (gauge.hpp).
enum class GaugeRule {
  kPrior,           ///< the prior, by corrections that are small together
  kNominalMarkers,  ///< the nominal positions of the root's markers
  kLink,            ///< a link that a joint on the root carries: it is at its nominal place
};

struct Gauge {
  GaugeRule rule = GaugeRule::kPrior;
  std::string link = {};  ///< of kLink
};

/// prior, nominal_markers, link NAME
std::string GaugeText(const Gauge& gauge);

/// Which causes beyond geometry and springs are estimated (corrections.hpp).
struct ExtraCauses {
  bool automatic = true;           ///< those that held-out errors ask for; else:
  std::vector<std::string> names;  ///< `*` stands for any run of characters; none: none
};

struct CalibrationOptions {
  Prior prior = {};
  /// Widen the prior where the estimates say that the robot is further from nominal than it expects
  /// (evidence approximation, MacKay 1992): by one factor for each PriorGroup, at least 1 and at
  /// most MostWidening. A prior that is too narrow biases the estimates and makes their
  /// uncertainty too small.
  bool widen_prior = true;
  /// What an earlier calibration of the robot says; of its parameters it is the prior, and it is
  /// not widened.
  EarlierEstimate earlier = {};
  /// By how much the zero of a joint drifts in a day, as a part of its prior's standard deviation,
  /// and other parameters by a quarter of that: what an earlier calibration says is less certain by
  /// the day (a random walk).
  double drift = 0.02;
  /// White noise of one marker coordinate, m. Zero: estimated from the residuals.
  double marker_sd = 0.0;
  /// What happens to observations that contradict the others (FindOutliers).
  OutlierPolicy outliers = OutlierPolicy::kRemove;
  /// Noise of a marker coordinate above this means that the model does not explain the recording,
  /// m.
  double plausible_marker_sd = 5e-3;
  /// Chance that a recording without a single outlier has one named all the same.
  double outlier_probability = 0.01;
  /// A parameter whose posterior standard deviation stays above this part of its prior one is
  /// listed as not supported by the data: they tell it at best together with others.
  double support_threshold = 0.9;
  /// Correlations at or above this are reported.
  double correlation_threshold = 0.9;
  SupportForm support_form = SupportForm::kNuisance;
  /// A foot whose markers are displaced by more than this between two postures has slipped: it
  /// stands elsewhere from there on, m.
  double slip = 1e-3;
  /// How far from flat on one level floor the soles of feet that carry the robot may be (see
  /// floor.hpp): slopes [rad], and heights against each other [m]; infinite: it is not used.
  double floor_tilt_sd = 0.1 * M_PI / 180.0, floor_height_sd = 1e-3;
  LoadOptions load = {};
  ExtraCauses extra = {};
  Gauge gauge = {};  ///< that a result is given at the end (ApplyGauge)
  int max_iterations = 100;
};

}  // namespace elastocal
