// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/validation/common_parameters.hpp"

namespace elastocal {

/// A calibrated session of a robot of the fleet.
struct FleetMember {
  std::string session, robot, batch;
  std::optional<double> day;
  double urdf_error = 0.0;  ///< held-out error of the calibrated URDF, m; NaN: unknown
  CalibrationEstimate estimate;
};

/// Distribution of a parameter over the robots of a fleet: deviations from nominal, SI.
struct FamilyParameter {
  std::string name, unit;
  double mean = 0.0;
  double sd = 0.0;  ///< between robots, without the uncertainty of their calibrations
  int robots = 0;   ///< number of robots whose data tell it
};

/// A parameter of a robot that differs from the other robots.
struct OutOfFamily {
  std::string robot, parameter, unit;
  double value = 0.0, family = 0.0;  ///< value of this robot, mean of the family, SI
  double sd = 0.0;                   ///< expected scatter of a robot of the family
  double p_adjusted = 1.0;           ///< p value corrected for all robots and parameters (Holm)
};

/// A parameter of a maker's batch that differs from the others.
struct BatchDifference {
  std::string batch, parameter, unit;
  double difference = 0.0, sd = 0.0;  ///< mean of the batch minus mean of the others
  double p_adjusted = 1.0;
};

/// Value of a parameter in one session of a robot, SI.
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

/// Result of StudyFamily.
struct FleetFamily {
  std::vector<FamilyParameter> parameters;
  std::vector<OutOfFamily> out_of_family;  ///< significant ones, the smallest p first
  std::vector<BatchDifference> batches;    ///< significant ones, likewise
  std::vector<ParameterDrift> drifts;      ///< significant ones, likewise
  std::vector<std::string> workshop;  ///< robots that are out of family or have far larger errors
  double median_error = 0.0;          ///< median of urdf_error, m
};

/// Finds what the robots of a fleet have in common, and which ones differ. Each robot counts by its
/// last session; a drift is the slope of a line through all its sessions with a day. Parameters
/// with the status `estimated` take part, each by itself. A robot is tested against the mean and
/// the scatter of the others (Student's t), a batch against the others (Welch), a slope against its
/// uncertainty; Holm's procedure is applied over all tests of a kind at `level`. A robot needs a
/// workshop if a joint is out of family or if the error of its URDF exceeds three times the median.
FleetFamily StudyFamily(const std::vector<FleetMember>& members, double level = 0.05);

/// The last session of each robot, in the order of the robots' first sessions.
std::vector<FleetMember> LastSessions(const std::vector<FleetMember>& members);

/// The fleet as prior of the next robot (empirical Bayes). The mean is that of the estimates. The
/// covariance is mean(S_r) + D, one step of expectation maximisation over N(mean, covariance), with
/// D the scatter of each parameter's estimates, shrunk towards the scatter of its kind with the
/// weight of `kind_robots` robots. It contains the parameters that all robots have. Throws
/// InputError for fewer than three robots.
CalibrationEstimate FleetPrior(const std::vector<FleetMember>& robots, double kind_robots = 4.0);

}  // namespace elastocal
