// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/validation/common_parameters.hpp"

namespace elastocal {

/// A calibrated session of a robot.
struct FleetMember {
  std::string session, robot, batch;
  std::optional<double> day;
  double urdf_error = 0.0;  ///< held-out error of the calibrated URDF, m; NaN: unknown
  CalibrationEstimate estimate;
};

/// A parameter over the robots of a fleet, deviations from nominal, SI.
struct FamilyParameter {
  std::string name, unit;
  double mean = 0.0;
  double sd = 0.0;  ///< between robots, without the uncertainty of their calibrations
  int robots = 0;   ///< whose data tell it
};

/// A robot unlike the others.
struct OutOfFamily {
  std::string robot, parameter, unit;
  double value = 0.0, family = 0.0;  ///< SI
  double sd = 0.0;                   ///< that a robot of the family would scatter by
  double p_adjusted = 1.0;           ///< by Holm over all robots and parameters
};

/// A maker's batch unlike the others.
struct BatchDifference {
  std::string batch, parameter, unit;
  double difference = 0.0, sd = 0.0;  ///< of the batch's mean from that of the others
  double p_adjusted = 1.0;
};

/// A parameter as a session of a robot found it, SI.
struct SessionValue {
  double day = 0.0, value = 0.0, sd = 0.0;
};

/// A parameter that changes over the sessions of a robot.
struct ParameterDrift {
  std::string robot, parameter, unit;
  double per_day = 0.0, sd = 0.0;
  double p_adjusted = 1.0;
  std::vector<SessionValue> sessions = {};  ///< in the order of the members
};

struct FleetFamily {
  std::vector<FamilyParameter> parameters;
  std::vector<OutOfFamily> out_of_family;  ///< significant ones, the least likely first
  std::vector<BatchDifference> batches;    ///< likewise
  std::vector<ParameterDrift> drifts;      ///< likewise
  std::vector<std::string> workshop;       ///< robots that are out of family or err far more
  double median_error = 0.0;               ///< of urdf_error, m
};

/// What the robots of a fleet have in common, and which differ. Each robot counts by its last
/// session; drift is a line through all sessions with a day. Parameters whose status is `estimated`
/// take part, each by itself: a robot against the mean and the scatter of the others (Student's t),
/// a batch against the others (Welch), the slope of a line against its uncertainty; Holm's
/// procedure over all tests of a kind at `level`. A robot needs a workshop if a joint is out of
/// family or its URDF errs by more than three times the median.
FleetFamily StudyFamily(const std::vector<FleetMember>& members, double level = 0.05);

/// The last session of each robot, in the order of the robots' first.
std::vector<FleetMember> LastSessions(const std::vector<FleetMember>& members);

/// The fleet as the prior of the next robot (empirical Bayes): mean of the estimates, and the
/// covariance mean(S_r) + D of one step of expectation maximisation over N(mean, covariance), with
/// D the scatter of the estimates, of each parameter by itself and drawn towards that of its kind
/// as if of `kind_robots` more robots. It has the parameters that all robots have. At least
/// three robots (InputError).
CalibrationEstimate FleetPrior(const std::vector<FleetMember>& robots, double kind_robots = 4.0);

}  // namespace elastocal
