// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/validation/common_parameters.hpp"
#include "elastocal/validation/shared_markers.hpp"
#include "elastocal/validation/significance.hpp"

namespace elastocal {

/// Settings of CompareCalibrations.
struct ComparisonOptions {
  /// Probability with which at least one joint of an unchanged robot is reported as moved.
  double level = 0.05;
  /// All markers were taken off and fixed anew in between, so that their positions tell nothing of
  /// the robot.
  bool new_markers = false;
};

/// A parameter that both calibrations A and B estimate, in rad, m or its other SI unit.
struct ParameterDifference {
  std::string name, joint, unit;
  double a = 0.0, b = 0.0;
  /// b - a, under the condition that the markers that have not moved are where they were.
  double difference = 0.0;
  double sd = 0.0;  ///< standard deviation of `difference`

  /// Degrees of freedom of its Student's t; infinite for the normal distribution.
  double degrees_of_freedom = 0.0;
  double half_width = 0.0;  ///< half width of its 95 % interval, for this parameter alone
  double p = 1.0;           ///< probability of at least this difference without a change

  bool significant() const { return p < 0.05; }
};

/// The differences of one joint's parameters and their common test.
struct JointDifference {
  std::string joint;
  std::vector<int> parameters;  ///< indices into CalibrationComparison::parameters, by ascending p
  DifferenceTest test;
  /// The p value corrected for the number of joints (Holm); the joint has moved if it is at or
  /// below the level.
  double p_adjusted = 1.0;
  bool moved = false;
  /// Links whose cluster may have moved instead: if all markers of one of them moved as one piece,
  /// the joint's differences would not be significant.
  std::vector<std::string> or_markers;
};

/// Result of CompareCalibrations.
struct CalibrationComparison {
  std::vector<JointDifference> joints;          ///< the most significant first
  std::vector<ParameterDifference> parameters;  ///< in the order of B
  DifferenceTest overall;                       ///< test of all parameters together
  bool changed = false;  ///< a joint has moved, or overall.p is at or below the level
  /// Joints of which any one alone, if it moved, would explain all differences. Only if something
  /// changed and no joint is significant by itself.
  std::vector<std::string> suspects;
  bool with_covariance = false;      ///< both covariances are known
  std::vector<LinkMarkers> markers;  ///< empty without covariance, or if all markers are new
  /// Parameters that could not be compared, with the reason.
  std::vector<NotCompared> not_compared;
  std::vector<std::string> warnings;
};

/// Compares two calibrations of one robot, A and B (paper section 6.1.3, Fig. 7), and finds the
/// joints that moved by more than the uncertainty of both.
///
/// **Uncertainty of a difference.** Both estimates are posterior means under a prior about nominal,
/// with posterior covariances S_a and S_b. The covariance of their difference is taken as S_a +
/// S_b.
/// - If the robots before and after are two draws from the prior, this is exactly the posterior
///   covariance of the change. It takes into account that estimates are pulled towards nominal in
///   directions that the recordings excite badly. The change of one joint therefore does not appear
///   as a significant change of another joint with which it can be confused.
/// - If nothing changed, both estimates are pulled by the same prior P, and the difference scatters
///   only with S_a + S_b - S_a P^-1 S_b - S_b P^-1 S_a, which is smaller on average. The level is
///   therefore kept, with a reserve for parameters that the prior determines in part; for
///   parameters that the data determine, both covariances agree.
///
/// The price is power: a change in a badly excited direction is estimated too small, and its
/// interval says so. The errors of the two recordings must be independent.
///
/// **Markers that stayed.** Some changes look alike: a turned last joint, and markers that were
/// turned with its link; a hip, and the markers on the root link together with all other branches.
/// Where both calibrations find the markers of a link at the same positions (FindUnmovedMarkers),
/// these markers are therefore assumed not to have moved by more than kMarkerReturns, and
/// differences and covariances are taken under this condition. A cluster that moved as one piece
/// may pass this test, so that a joint is accused in its place; `or_markers` then names it. Where
/// several joints, or none, are significant and one cluster explains all differences, that cluster
/// is taken to have moved (LinkMarkers::as_one_piece).
///
/// **A joint** is tested by all its common parameters together (marginally, whatever else may have
/// moved). The test is Fisher's F with their number and the degrees of freedom of the noise (Welch
/// and Satterthwaite for two different noises, from the files' interval factors). **Over the
/// joints** Holm's step-down procedure keeps the probability of any false alarm at the level,
/// whatever their correlation. If a covariance is missing, the p value of a joint is the smallest
/// one of its parameters times their number (Bonferroni).
///
/// **Two models.** A parameter that only one side estimates (a cause, a spring, a parameter that
/// the other side holds) changes the other estimates of that side. Both calibrations are therefore
/// compared under what both models have: each estimate as it would be with these parameters fixed
/// at their values in the other (FixedIn, Conditioned). A warning names them. This needs both
/// covariances.
///
/// The uncertainty covers noise only. Effects that neither model has (for example elasticity) make
/// two recordings of different postures differ by more.
///
/// If a recording can hardly tell two joints apart, both may be insignificant although something
/// changed. The test of all parameters together then finds the change, and `suspects` are named
/// instead.
///
/// Throws InputError if the nominal robots or the gauges differ, if the calibrations have nothing
/// in common, or if a covariance does not fit its calibration.
CalibrationComparison CompareCalibrations(const CalibrationEstimate& a,
                                          const CalibrationEstimate& b,
                                          const ComparisonOptions& options);

}  // namespace elastocal
