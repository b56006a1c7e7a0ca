// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/validation/common_parameters.hpp"
#include "elastocal/validation/shared_markers.hpp"
#include "elastocal/validation/significance.hpp"

namespace elastocal {

struct ComparisonOptions {
  /// Probability that any joint of an unchanged robot is reported as moved.
  double level = 0.05;
  /// Whether markers were taken off and fixed anew in between, all of them, so that their places
  /// tell nothing of the robot.
  bool new_markers = false;
};

/// A parameter that both calibrations tell, in rad, m or its other SI unit.
struct ParameterDifference {
  std::string name, joint, unit;
  double a = 0.0, b = 0.0;
  /// b - a, and what is then left of it with the markers that have not moved where they were.
  double difference = 0.0;
  double sd = 0.0;  ///< of the difference

  double degrees_of_freedom = 0.0;  ///< of its Student's t; infinite for the normal distribution
  double half_width = 0.0;          ///< half width of its 95 % interval, for this parameter alone
  double p = 1.0;                   ///< probability of a difference as large without a change

  bool significant() const { return p < 0.05; }
};

struct JointDifference {
  std::string joint;
  std::vector<int> parameters;  ///< indices into CalibrationComparison::parameters, by p
  DifferenceTest test;
  double p_adjusted = 1.0;  ///< by Holm: the joint has moved if it is at or below the level
  bool moved = false;
  /// Links whose markers, if all on one of them had moved together, would make it insignificant:
  /// either that happened or the joint has moved.
  std::vector<std::string> or_markers;
};

struct CalibrationComparison {
  std::vector<JointDifference> joints;          ///< the most significant first
  std::vector<ParameterDifference> parameters;  ///< in the order of B
  DifferenceTest overall;                       ///< of all parameters together
  bool changed = false;  ///< whether a joint has moved, or overall.p is at or below the level
  /// Joints of which any one alone, if it moved, would explain all differences. Only if something
  /// changed and no joint could be singled out.
  std::vector<std::string> suspects;
  bool with_covariance = false;      ///< whether both covariances were known
  std::vector<LinkMarkers> markers;  ///< empty without covariance, or if all markers are new
  std::vector<NotCompared> not_compared;
  std::vector<std::string> warnings;
};

/// Compares two calibrations of one robot, A and B (paper section 6.1.3, Fig. 7), and finds the
/// joints that moved by more than the uncertainty of both.
///
/// **Uncertainty of a difference.** Both estimates are posterior means under a prior around
/// nominal, with posterior covariances S_a and S_b. The covariance of their difference is taken as
/// S_a + S_b.
/// - If the robot before and after are two draws from the prior, that is exactly the posterior
///   covariance of the change. It takes into account that estimates are pulled towards nominal in
///   directions that the recordings excite badly. So the change of one joint does not appear as a
///   significant change of another joint with which it can be confused.
/// - If nothing changed, both are pulled by the same prior P, and the difference scatters with S_a
///   + S_b - S_a P^-1 S_b - S_b P^-1 S_a only, which is smaller on average. So the level is kept,
///   with a reserve for parameters that the prior determines in part; for parameters that the data
///   determine, both covariances agree.
/// The price is power: a change in a badly excited direction is estimated too small, and its
/// interval says so. Errors of the two recordings must be independent.
///
/// **Markers that stayed.** A turned last joint and markers that were turned with its link look the
/// same, and so do a hip and the markers on the root link together with all other branches. The
/// places of markers are therefore not left open where both calibrations find them the same
/// (FindUnmovedMarkers): differences and covariances are those that are left if these markers have
/// not moved by more than kMarkerReturns. A cluster that moved as one piece may hide in this way,
/// and a joint be accused in its place: `or_markers` names it. Several joints, or differences of
/// which none is singled out, are not put down to the robot where one cluster explains them, which
/// is then taken to have moved (LinkMarkers::as_one_piece).
///
/// **A joint** is tested by all its common quantities together (marginally, whatever else may have
/// moved), by Fisher's F with their number and the degrees of freedom of the noise (Welch and
/// Satterthwaite for two different noises, from the files' interval factors). **Over the joints**
/// Holm's step-down procedure keeps the probability of any false alarm at the level, whatever their
/// correlation. If a covariance is missing, the p value of a joint is the smallest one of its
/// parameters times their number (Bonferroni).
///
/// **Two models.** What one side alone estimates (a cause, a spring, a parameter that the other
/// side holds) is in the other estimates of that other side. Both are therefore compared under what
/// both models have: each estimate as it would be with these parameters fixed as in the other
/// (FixedIn, Conditioned). A warning names them. This needs both covariances.
///
/// The uncertainty is only that of noise. Effects that neither model has (for example elasticity)
/// make two recordings of different postures differ by more.
///
/// If a recording can hardly tell two joints apart, both may be insignificant although something
/// changed. The test of everything together then finds the change, and `suspects` are named
/// instead.
///
/// Throws InputError if the nominal robots differ, if the calibrations have nothing in common, or
/// if a covariance does not fit its calibration.
CalibrationComparison CompareCalibrations(const CalibrationEstimate& a,
                                          const CalibrationEstimate& b,
                                          const ComparisonOptions& options);

}  // namespace elastocal
