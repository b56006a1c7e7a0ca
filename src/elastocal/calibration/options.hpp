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

/// The group of a kind of parameter of a joint or leg.
PriorGroup GroupOf(ParameterKind kind);

/// Largest factor by which the prior of a group is widened: 10 for geometry and corrections, beyond
/// which nothing is an error of a robot; 100 for elastic parameters, which differ far more from
/// robot to robot.
double MostWidening(PriorGroup group);

/// Factors by which a prior is widened, by group.
struct PriorScale {
  std::array<double, kPriorGroupCount> factor;

  PriorScale() { factor.fill(1.0); }
  double& operator[](PriorGroup group) { return factor[static_cast<int>(group)]; }
  double operator[](PriorGroup group) const { return factor[static_cast<int>(group)]; }
};

/// Standard deviations of the Gaussian prior about nominal, by kind of parameter, in the
/// parameter's SI unit. All parameters have a prior, so that all can be estimated together: what
/// the data do not tell apart is divided as the priors say. docs/formats.md gives the reasons.
struct Prior {
  /// By kind: 0.5 degrees and 1 mm for joints; 1 rad and 1 m for T0 and markers, of which nothing
  /// is known beforehand; 5e-5 rad/(N.m) about and 1e-5 m/N along an axis for legs; 2 N.m for
  /// torque sensors. 0 for torsion and bending, whose prior follows from `deflection`.
  std::array<double, kParameterKindCount> sd;
  /// Deflection of a revolute joint, about and across its axis, under its largest torque (the
  /// URDF's effort), rad, from which the prior of torsion and bending follows: strong joints are
  /// stiff. Without effort it is 5e-5 rad/(N.m). (Corrections and linkages have priors of their
  /// own.)
  double deflection = 0.01;
  /// The same of a prismatic joint along its axis, m; without effort it is 1e-6 m/N. A lift carries
  /// a nearly constant weight, so that its compliance is a displacement that only the prior tells
  /// from an offset.
  double slide_deflection = 1e-3;
  PriorScale scale = {};  ///< factors on all standard deviations

  Prior();
  double& operator[](ParameterKind kind) { return sd[static_cast<int>(kind)]; }
  double operator[](ParameterKind kind) const { return sd[static_cast<int>(kind)]; }

  /// Widened standard deviation for a parameter of the robot; at most 1000 units of ParameterScale,
  /// which counts as unknown.
  double Of(const RobotTree& tree, const Parameter& parameter) const;
};

/// Unit of a parameter in the solver, such that all parameters have a similar influence: 0.5
/// degrees, 1 mm, 5e-5 rad/(N.m), ...; 0.01 (m or rad) for T0 and markers.
double ParameterScale(const Parameter& parameter);

/// How the support foot's constraint (eq. 14) enters.
enum class SupportForm {
  /// The waist of each posture is unknown. The elastic leg ties it to the foot within an estimated
  /// standard deviation, and the markers on the waist and on what it carries see it.
  kNuisance,
  /// The leg counts as exact: every posture hangs on the foot.
  kFootRooted,
};

/// What happens to outliers.
enum class OutlierPolicy {
  kRemove,  ///< they are named and left out
  kKeep,    ///< they are named and kept, at the weight that heavy tails give them
};

/// Rule that chooses the root link's frame, which no measurement tells (gauge.hpp).
enum class GaugeRule {
  kPrior,  ///< the prior chooses: the corrections together are small
  /// The markers on the root link keep their nominal positions as well as possible.
  kNominalMarkers,
  kLink,  ///< a link that a joint on the root carries keeps its nominal place
};

struct Gauge {
  GaugeRule rule = GaugeRule::kPrior;
  std::string link = {};  ///< for kLink: name of the link
};

/// prior, nominal_markers, link NAME
std::string GaugeText(const Gauge& gauge);

/// Which causes beyond geometry and springs are estimated (corrections.hpp).
struct ExtraCauses {
  /// Take the causes that lower held-out errors; if false, those in `names`.
  bool automatic = true;
  std::vector<std::string> names;  ///< `*` stands for any run of characters; empty: no cause
};

struct CalibrationOptions {
  Prior prior = {};
  /// Whether to widen the prior where the estimates are further from nominal than it expects
  /// (evidence approximation, MacKay 1992): by one factor for each PriorGroup, from 1 to
  /// MostWidening. A prior that is too narrow biases the estimates and makes their uncertainty too
  /// small.
  bool widen_prior = true;
  /// Result of an earlier calibration of the robot. It is the prior of its parameters and is not
  /// widened.
  EarlierEstimate earlier = {};
  /// Drift of a joint's zero in one day, as a share of its prior's standard deviation (a random
  /// walk); other parameters drift by a quarter of that. An earlier calibration becomes less
  /// certain by it from day to day.
  double drift = 0.02;
  /// White noise of one marker coordinate, m. Zero: estimated from the residuals.
  double marker_sd = 0.0;
  /// What happens to observations that contradict the others (FindOutliers).
  OutlierPolicy outliers = OutlierPolicy::kRemove;
  /// Noise of a marker coordinate, m, above which the model does not explain the recording.
  double plausible_marker_sd = 5e-3;
  /// Probability that at least one outlier is named in a recording without any.
  double outlier_probability = 0.01;
  /// A parameter is unsupported if its posterior standard deviation is at least this share of its
  /// prior one: the data tell it at best together with others.
  double support_threshold = 0.9;
  /// Correlations at or above this are reported.
  double correlation_threshold = 0.9;
  SupportForm support_form = SupportForm::kNuisance;
  /// Displacement of a foot's markers between two postures, m, above which the foot has slipped and
  /// stands elsewhere from then on.
  double slip = 1e-3;
  /// Standard deviations by which the soles of feet that carry the robot deviate from flat on one
  /// level floor (floor.hpp): tilt [rad] and height against each other [m]. Infinite: the floor is
  /// not used.
  double floor_tilt_sd = 0.1 * M_PI / 180.0, floor_height_sd = 1e-3;
  LoadOptions load = {};
  ExtraCauses extra = {};
  Gauge gauge = {};  ///< gauge that a result has at the end (ApplyGauge)
  int max_iterations = 100;
};

}  // namespace elastocal
