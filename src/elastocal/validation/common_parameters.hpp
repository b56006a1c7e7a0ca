#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// One parameter in the result of a calibration. Units are kept as text, so that parameters of any
/// kind can be compared.
struct ParameterEstimate {
  std::string name;       ///< see OwnerName
  std::string unit;       ///< of value and sd, SI: "rad", "m", ...
  bool external = false;  ///< belongs to the experiment, not to the robot; see IsExternal
  ParameterStatus status = ParameterStatus::kEstimated;
  double value = 0.0;  ///< deviation from nominal
  double sd = 0.0;     ///< NaN where none applies
  /// For a dropped parameter, its shares in the kept ones, by name.
  std::map<std::string, double> regrouped_into = {};
};

/// A calibration as read back from its files.
struct CalibrationEstimate {
  std::string source;  ///< the file, for messages
  std::string robot;
  std::string nominal;            ///< fingerprint of the nominal robot
  std::string recording;          ///< from which it was made
  std::string model;              ///< ModelKindName
  double interval_factor = 1.96;  ///< half width of a 95 % interval in standard deviations
  std::vector<ParameterEstimate> parameters;
  /// Names of the parameters in `covariance`, among them all estimated ones. Empty if the
  /// covariance is unknown.
  std::vector<std::string> covariance_names;
  Eigen::MatrixXd covariance;

  bool has_covariance() const { return !covariance_names.empty(); }
};

/// The joint or leg to which a parameter belongs: the part of its name before the last dot. The
/// bias of a torque sensor is its own owner, because it drifts even if the joint has not moved.
std::string OwnerName(const std::string& parameter);

/// One quantity of the robot that two calibrations A and B both determine. Usually it is a
/// parameter kept by both. If the two keep different ones of the same dependent parameters, it is a
/// combination: weights_a . values of A and weights_b . values of B estimate the same quantity.
struct CommonParameter {
  std::string name;   ///< of the parameter of B that has weight 1
  std::string joint;  ///< OwnerName of `name`
  std::string unit;
  Eigen::VectorXd weights_a, weights_b;  ///< one entry for each parameter of A, of B
  /// What the quantity contains besides the parameter `name`: dropped parameters that no
  /// measurement can tell from it, with their coefficients.
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

/// Finds the quantities of the robot that both calibrations determine. External parameters are not
/// compared.
///
/// An estimate of a kept parameter stands for a combination: the parameter itself and its shares of
/// the dropped ones (section 2.1). It is the same quantity in A and B only if the combinations are
/// equal, which depends on the joints that move a marker, on the priority and on the held
/// parameters. Beyond equal ones, linear algebra finds combinations of several parameters
/// (`with_combinations`; their uncertainty needs the covariance). A combination with external
/// parameters is never compared, because these differ between experiments. Parameters held in one
/// calibration are taken as nominal there.
CommonParameters FindCommonParameters(const CalibrationEstimate& a, const CalibrationEstimate& b,
                                      bool with_combinations);

}  // namespace elastocal
