#pragma once

#include <array>
#include <limits>

#include "elastocal/robot/parameters.hpp"
#include "elastocal/robot/posture_loads.hpp"

namespace elastocal {

/// Factors by which a prior is widened.
struct PriorScale {
  double angles = 1.0, lengths = 1.0;
};

/// The prior is widened no further than this: what lies beyond is no error of a robot.
inline constexpr double kMaxPriorScale = 10.0;

/// Standard deviation of the Gaussian prior on each kind of parameter, around nominal, in the
/// parameter's SI unit; infinite for none. T0 and marker positions have none: nobody knows them
/// beforehand.
struct Prior {
  std::array<double, kParameterKindCount> sd;

  /// 0.5 degrees and 1 mm on joints, none on T0 and markers; torsion, bending and legs about an
  /// axis 5e-5 rad/(N.m), legs along an axis 1e-5 m/N, torque sensors 2 N.m.
  Prior();
  /// The prior with the standard deviations of angles and of lengths multiplied; elastic ones stay.
  Prior Scaled(const PriorScale& scale) const;
  double& operator[](ParameterKind kind) { return sd[static_cast<int>(kind)]; }
  double operator[](ParameterKind kind) const { return sd[static_cast<int>(kind)]; }
};

/// How the support foot's constraint (eq. 14) enters.
enum class SupportForm {
  /// The waist of each posture is unknown: tied to the foot by the elastic leg within what that
  /// model leaves unexplained (estimated), and seen by its markers and those it carries.
  kNuisance,
  /// The leg is taken as exact: everything hangs on the foot.
  kFootRooted,
  /// The waist's own markers are taken as exact, as eq. 2 does; the foot may vary at a penalty.
  kPenalty,
};

struct CalibrationOptions {
  Prior prior = {};
  /// Widen the prior, angles by one factor and lengths by another, each at least 1 and at most 10,
  /// where the estimates say that the robot is further from nominal than the prior expects
  /// (evidence approximation, MacKay 1992). A prior that is too narrow biases the estimates and
  /// makes their uncertainty too small.
  bool widen_prior = true;
  /// Standard deviation of one marker coordinate, m. Zero: estimated from the residuals.
  double marker_sd = 0.0;
  /// Noise of a marker coordinate above this means that the model does not explain the recording,
  /// m.
  double plausible_marker_sd = 5e-3;
  /// Chance that a recording without a single outlier has one named all the same.
  double outlier_probability = 0.01;
  /// A parameter whose posterior standard deviation stays above this part of its prior one is not
  /// supported by the data: held at nominal and listed.
  double support_threshold = 0.9;
  /// Correlations at or above this are reported.
  double correlation_threshold = 0.9;
  SupportForm support_form = SupportForm::kNuisance;
  /// A foot whose markers are displaced by more than this between two postures has slipped: it
  /// stands elsewhere from there on, m.
  double slip = 1e-3;
  LoadOptions load = {};
  int max_iterations = 100;
};

}  // namespace elastocal
