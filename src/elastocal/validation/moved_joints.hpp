// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/validation/shared_markers.hpp"
#include "elastocal/validation/significance.hpp"

namespace elastocal {

/// By how much a parameter of a joint has changed since the earlier calibration, if that joint
/// alone has moved.
struct ParameterChange {
  std::string name;
  ParameterUnit unit;
  double value = 0.0, sd = 0.0;  ///< SI
};

struct JointSuspect {
  std::string joint;
  DifferenceTest test;      ///< of all its parameters at once; no parameters: the data cannot tell
  double p_adjusted = 1.0;  ///< by Holm, over the joints that the data can tell
  /// Natural logarithm of p(data | it has moved) / p(data | nothing has).
  double log_evidence = 0.0;
  /// That this joint has moved, if exactly one has, each being as likely beforehand.
  double probability = 0.0;
  bool zero_told = false;  ///< whether the data tell a change of its zero
  bool zero_is_length = false;
  double smallest_seen = 0.0;            ///< change of its zero (SmallestChange), rad or m
  bool zero_alone = false;               ///< whether that alone explains it best
  std::vector<ParameterChange> changes;  ///< of its zero alone, or of all its parameters

  bool told() const { return test.parameters > 0; }
};

struct JointCheck {
  /// As seen beside the joints that are found to have moved; the most probable first.
  std::vector<JointSuspect> joints;
  std::vector<JointSuspect> moved;  ///< in the order in which they were found; beside the others
  /// Where something has changed and no single joint can be named: those of which one may be it.
  std::vector<std::string> suspects;
  std::vector<std::string> not_told;  ///< joints of which a change of the zero cannot be seen
  std::vector<LinkMarkers> markers;   ///< whether they are where the earlier calibration has them
  /// Links whose markers, all on one of them moved as one piece, would explain what has changed.
  std::vector<std::string> or_markers;
  /// By how much the covariance of the earlier calibration is too small (variance, at least 1), as
  /// the data have it: errors of its model are others in other postures.
  double widened = 1.0;
  /// Natural logarithm of p(data | this has moved, the earlier calibration so wide) / p(data |
  /// nothing has, as it is), each joint being as likely to have moved.
  double log_evidence = 0.0;

  bool changed() const { return !moved.empty() || !suspects.empty(); }
};

struct JointCheckOptions {
  double level = 0.05;      ///< chance that any joint of an unchanged robot is accused
  double certainty = 0.95;  ///< probability from which on a single joint is named
  /// Whether markers were taken off and fixed anew since, all of them, so that their places tell
  /// nothing of the robot.
  bool new_markers = false;
};

/// Whether a parameter is what a turned encoder changes: theta, of a prismatic joint r; of a motor
/// with a rod its zero, of a linear actuator its length.
bool IsZeroOffset(const Parameter& parameter, const RobotTree& tree);

/// Standard deviation of a change that a joint's parameters may have made at once: twice the prior
/// of a new robot; 0 of parameters that do not jump (springs, legs, sensors). By the names of
/// `earlier`.
Eigen::VectorXd SizeOfChanges(const EarlierEstimate& earlier, const ErrorModel& model,
                              const Prior& prior);

/// The smallest change of a joint's zero that FindMovedJoints sees nine times in ten, where the
/// data tell it with the standard deviation `sd`, and `size` is that of a change beforehand;
/// infinite where the data do not tell it. `joints`: among which the one is sought.
double SmallestChange(double sd, double size, std::size_t joints);

/// Finds joints that have moved since an earlier calibration, from a recording too small to
/// calibrate by.
///
/// `estimate` is fitted to that recording with the prior `fitted_with`, wide enough that a change
/// does not end in its noise: N(earlier.mean, earlier.covariance + diag(size^2)) of the robot. Its
/// linearisation gives what the data say whatever the prior (InformationOfData): their information
/// A and vector h, and at the earlier estimate the score s = h - A mean. Under the hypothesis that
/// some joints moved, s ~ N(0, A + A P A) with P that of the earlier calibration, widened in the
/// parameters of these joints. `earlier` may know more than `fitted_with`, such as where markers
/// are.
/// - A joint is **tested** by what its parameters would explain of s beside all that the earlier
///   calibration leaves open (score test; Fisher's F with the degrees of freedom of the noise),
///   adjusted for the number of joints by Holm.
/// - Joints are **told apart** by their evidence p(s | joint moved), of its zero alone or of all
///   its parameters.
/// The most probable joint is accepted, and the search goes on beside it, until no joint is
/// significant with an evidence that outweighs its choice among the joints and the odds against a
/// move, three to one. Those that are not significant beside the others are left out again. One of
/// the rest has moved if, beside the others, it is the only one that is likely; else it is one of
/// the suspects.
///
/// All of this is done with the covariance of the earlier calibration as it is and 2, 4, 8 and 16
/// times as large, and the most probable of these counts: an earlier calibration that is less exact
/// in these postures than it says differs in many parameters by some standard deviations, a joint
/// that has moved in a few by many.
JointCheck FindMovedJoints(const CalibrationResult& estimate, const EarlierEstimate& fitted_with,
                           const EarlierEstimate& earlier, const Eigen::VectorXd& size_of_changes,
                           const JointCheckOptions& options = {});

}  // namespace elastocal
