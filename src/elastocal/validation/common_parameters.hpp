// SPDX-License-Identifier: Apache-2.0
#pragma once

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
};

/// A marker of a calibration, whose parameters are `marker.<name>.x`, `.y` and `.z`.
struct MarkerPlace {
  std::string name, link;
  /// Where the project has it in the frame of its link, m: its parameters deviate from there, along
  /// the axes of that frame.
  Eigen::Vector3d nominal = Eigen::Vector3d::Zero();
};

/// A calibration as read back from its files.
struct CalibrationEstimate {
  std::string source;  ///< the file, for messages
  std::string robot;
  std::string nominal;            ///< fingerprint of the nominal robot
  std::string recording;          ///< from which it was made
  std::string model;              ///< ModelKindName
  std::string gauge = "prior";    ///< GaugeText
  double interval_factor = 1.96;  ///< half width of a 95 % interval in standard deviations
  std::vector<ParameterEstimate> parameters;
  /// Names of the parameters in `covariance`, among them all estimated ones. Empty if the
  /// covariance is unknown.
  std::vector<std::string> covariance_names;
  Eigen::MatrixXd covariance;
  std::vector<MarkerPlace> markers;  ///< empty if the file does not have them

  bool has_covariance() const { return !covariance_names.empty(); }
};

/// The joint or leg to which a parameter belongs: the part of its name before the last dot. The
/// bias of a torque sensor is its own owner, because it drifts even if the joint has not moved.
std::string OwnerName(const std::string& parameter);

/// A parameter of the robot that two calibrations A and B both tell.
struct CommonParameter {
  std::string name;
  std::string joint;  ///< OwnerName of `name`
  std::string unit;
  int in_a = 0, in_b = 0;  ///< indices into the parameters of A and B
};

struct NotCompared {
  std::string name, reason;
};

struct CommonParameters {
  std::vector<CommonParameter> common;
  /// Parameters of the robot that no entry of `common` uses, and why.
  std::vector<NotCompared> not_compared;
};

/// Finds the parameters of the robot about which the data of both calibrations tell more than the
/// prior, in the order of B. External parameters are not compared: these differ between
/// experiments. Parameters held in either calibration are not compared.
CommonParameters FindCommonParameters(const CalibrationEstimate& a, const CalibrationEstimate& b);

}  // namespace elastocal
