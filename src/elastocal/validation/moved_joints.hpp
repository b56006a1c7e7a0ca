// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/validation/shared_markers.hpp"
#include "elastocal/validation/significance.hpp"

namespace elastocal {

/// Change of a joint's parameter since the earlier calibration, if that joint alone has moved.
struct ParameterChange {
  std::string name;
  ParameterUnit unit;
  double value = 0.0, sd = 0.0;  ///< SI
};

/// What a recording says about one joint.
struct JointSuspect {
  std::string joint;
  /// Test of its change, by its zero alone or by all its parameters (the smaller p, doubled); no
  /// parameters: the data cannot tell.
  DifferenceTest test;
  /// The p value corrected for the number of joints that the data can tell (Holm)
  double p_adjusted = 1.0;
  /// Natural logarithm of p(data | it has moved) / p(data | nothing has moved).
  double log_evidence = 0.0;
  /// Probability that this joint has moved, if exactly one has (beside those taken as moved) and
  /// all are equally likely beforehand.
  double probability = 0.0;
  bool zero_told = false;  ///< the data tell a change of its zero
  bool zero_is_length = false;
  /// Smallest change of its zero that would be seen (SmallestChange), rad or m.
  double smallest_seen = 0.0;
  bool zero_alone = false;               ///< a change of the zero alone explains the data best
  std::vector<ParameterChange> changes;  ///< change of its zero alone, or of all its parameters

  bool told() const { return test.parameters > 0; }
};

/// Result of FindMovedJoints.
struct JointCheck {
  /// All joints, beside those in `moved`; the most probable first.
  std::vector<JointSuspect> joints;
  /// Joints that have moved, in the order in which they were found; each judged beside the others.
  std::vector<JointSuspect> moved;
  /// Joints of which at least one has moved, where no single joint can be named.
  std::vector<std::string> suspects;
  std::vector<std::string> not_told;  ///< joints whose change of zero the data cannot tell
  std::vector<LinkMarkers> markers;  ///< whether markers are where the earlier calibration has them
  /// Links whose cluster, if it moved as one piece, would explain the change.
  std::vector<std::string> or_markers;
  /// Factor (variance, at least 1) by which the covariance of the earlier calibration is too small
  /// according to the data: the errors of its model differ in other postures.
  double widened = 1.0;
  /// Natural logarithm of p(data | these joints have moved, covariance times `widened`) / p(data |
  /// nothing has moved, covariance as it is), with all joints equally likely to have moved.
  double log_evidence = 0.0;

  bool changed() const { return !moved.empty() || !suspects.empty(); }
};

/// Settings of FindMovedJoints.
struct JointCheckOptions {
  double level = 0.05;      ///< probability with which any joint of an unchanged robot is accused
  double certainty = 0.95;  ///< probability from which a single joint is named
  /// All markers were taken off and fixed anew since, so that their positions tell nothing of the
  /// robot.
  bool new_markers = false;
};

/// Standard deviation of a sudden change of each parameter of `earlier`, SI: twice the prior of a
/// new robot; 0 for parameters that do not jump (springs, legs, sensors).
Eigen::VectorXd SizeOfChanges(const EarlierEstimate& earlier, const ErrorModel& model,
                              const Prior& prior);

/// The smallest change of a joint's zero that FindMovedJoints finds nine times in ten. `sd` is the
/// standard deviation with which the data tell the zero, `size` that of a change beforehand,
/// `joints` the number of joints that may have moved. Infinite where `size` is smaller than `sd`.
double SmallestChange(double sd, double size, std::size_t joints);

/// Finds joints that have moved since an earlier calibration, by a recording that is too small for
/// a calibration.
///
/// `estimate` is fitted to that recording with the prior `fitted_with`, which must be wide enough
/// that a change is not absorbed by the noise: N(earlier.mean, earlier.covariance + diag(size^2))
/// for the robot. Its linearisation gives the log-likelihood without the prior (InformationOfData):
/// information A and vector h, and at the earlier estimate the score s = h - A mean. Under the
/// hypothesis that some joints moved, s ~ N(0, A + A P A), where P is the covariance of the earlier
/// calibration, enlarged in the parameters of these joints. `earlier` may know more than
/// `fitted_with`, such as the positions of markers.
/// - A joint is **tested** by what its parameters explain of s beside all that the earlier
///   calibration leaves open (score test; Fisher's F with the degrees of freedom of the noise),
///   corrected for the number of joints by Holm.
/// - Joints are **told apart** by their evidence p(s | joint moved), as the mean of a change of the
///   zero alone and of all parameters.
///
/// The most probable significant joint is accepted, and the search is repeated beside it, until no
/// joint is significant. A joint is significant if its p value is at or below the level and its
/// evidence exceeds the number of joints times the odds against a move, three to one. Joints that
/// are not significant beside the others are removed again. A remaining joint has moved if, beside
/// the others, its probability is at least `certainty`; otherwise it is one of the suspects.
///
/// All of this is done with the covariance of the earlier calibration multiplied by 1, 2, 4, 8 and
/// 16, and the most probable result counts. An earlier calibration that is less exact in these
/// postures than it says differs in many parameters by some standard deviations; a joint that has
/// moved differs in a few by many.
JointCheck FindMovedJoints(const CalibrationResult& estimate, const EarlierEstimate& fitted_with,
                           const EarlierEstimate& earlier, const Eigen::VectorXd& size_of_changes,
                           const JointCheckOptions& options = {});

}  // namespace elastocal
