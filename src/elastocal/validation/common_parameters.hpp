#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// One parameter as a calibration leaves it. Units are kept as text, so that parameters of any kind
/// can be compared.
struct ParameterEstimate {
  std::string name;       ///< see OwnerName
  std::string unit;       ///< of value and sd, SI: "rad", "m", ...
  bool external = false;  ///< of the experiment, not of the robot: see IsExternal
  ParameterStatus status = ParameterStatus::kEstimated;
  double value = 0.0;  ///< deviation from nominal
  double sd = 0.0;     ///< NaN where none applies
  /// Of a dropped one: what of it shows up in kept ones, by name.
  std::map<std::string, double> regrouped_into = {};
};

/// A calibration as it can be read back from its files.
struct CalibrationEstimate {
  std::string source;  ///< the file, for messages
  std::string robot;
  std::string nominal;            ///< fingerprint of the nominal robot
  std::string recording;          ///< what it was made from
  std::string model;              ///< ModelKindName
  double interval_factor = 1.96;  ///< half width of a 95 % interval in standard deviations
  std::vector<ParameterEstimate> parameters;
  /// Covariance of parameters by name, estimated ones among them; empty: unknown.
  std::vector<std::string> covariance_names;
  Eigen::MatrixXd covariance;

  bool has_covariance() const { return !covariance_names.empty(); }
};

/// The joint or leg that a parameter is of: what comes before the last dot of its name. The bias of
/// a torque sensor is on its own: it drifts though the joint has not moved.
std::string OwnerName(const std::string& parameter);

/// One quantity of the robot that two calibrations A and B both determine. Mostly a parameter kept
/// by both. Where the two keep different ones of the same dependent parameters, a combination:
/// weights_a . values of A and weights_b . values of B estimate the same thing.
struct CommonParameter {
  std::string name;   ///< of the parameter of B that has weight 1
  std::string joint;  ///< OwnerName of `name`
  std::string unit;
  Eigen::VectorXd weights_a, weights_b;  ///< one a parameter of A, of B
  /// What the quantity consists of beside the parameter `name`: parameters that no measurement can
  /// tell from it (regrouped), with their coefficients.
  std::map<std::string, double> stands_for = {};
};

struct NotCompared {
  std::string name, reason;
};

struct CommonParameters {
  std::vector<CommonParameter> common;
  /// Parameters of the robot that no entry of `common` uses, and why.
  std::vector<NotCompared> not_compared;
};

/// Finds what both calibrations determine about the robot; external parameters are not compared.
///
/// A kept parameter stands for a combination: itself and its share of what was dropped (section
/// 2.1). It is the same quantity in A and B only if that combination is the same, which depends on
/// the joints that move a marker, on the priority and on what was held. Beyond equal ones,
/// combinations of several parameters are found by linear algebra (`with_combinations`; their
/// uncertainty needs the covariance). A combination that contains external parameters is never
/// compared: those differ between experiments. Parameters held in one calibration are taken as
/// known to be nominal there.
CommonParameters FindCommonParameters(const CalibrationEstimate& a, const CalibrationEstimate& b,
                                      bool with_combinations);

}  // namespace elastocal
