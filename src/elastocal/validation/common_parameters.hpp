// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// One parameter in the result of a calibration. Its unit is a text, so that parameters of any kind
/// can be compared.
struct ParameterEstimate {
  std::string name;       ///< name, whose owner is told by OwnerName
  std::string unit;       ///< SI unit of value and sd: "rad", "m", ...
  bool external = false;  ///< belongs to the experiment, not to the robot; see IsExternal
  ParameterStatus status = ParameterStatus::kEstimated;
  double value = 0.0;  ///< deviation from nominal
  double sd = 0.0;     ///< NaN where none applies
};

/// A marker of a calibration. Its parameters are `marker.<name>.x`, `.y` and `.z`.
struct MarkerPlace {
  std::string name, link;
  /// Nominal position in the frame of its link, m. The parameters are deviations from it along the
  /// axes of that frame.
  Eigen::Vector3d nominal = Eigen::Vector3d::Zero();
};

/// A calibration as read back from its files.
struct CalibrationEstimate {
  std::string source;  ///< the file, for messages
  std::string robot;
  std::string nominal;            ///< fingerprint of the nominal robot
  std::string recording;          ///< the recording from which it was made
  std::string model;              ///< ModelKindName
  std::string gauge = "prior";    ///< GaugeText
  double interval_factor = 1.96;  ///< half width of a 95 % interval in standard deviations
  std::vector<ParameterEstimate> parameters;
  /// Names of the parameters in `covariance`; all estimated parameters are among them. Empty if the
  /// covariance is unknown.
  std::vector<std::string> covariance_names;
  Eigen::MatrixXd covariance;
  std::vector<MarkerPlace> markers;  ///< empty if the file does not have them

  bool has_covariance() const { return !covariance_names.empty(); }
};

/// The joint or leg to which a parameter belongs: the part of its name before the last dot. The
/// bias of a torque sensor is its own owner, because it drifts even if the joint has not moved.
std::string OwnerName(const std::string& parameter);

/// A parameter of the robot that both calibrations A and B estimate.
struct CommonParameter {
  std::string name;
  std::string joint;  ///< OwnerName of `name`
  std::string unit;
  int in_a = 0, in_b = 0;  ///< indices into the parameters of A and B
};

/// A parameter that is not compared, with the reason.
struct NotCompared {
  std::string name, reason;
};

/// Result of FindCommonParameters.
struct CommonParameters {
  std::vector<CommonParameter> common;
  /// Parameters of the robot that are not in `common`, with the reason.
  std::vector<NotCompared> not_compared;
};

/// Finds the parameters of the robot that both calibrations estimate (by data better than by the
/// prior), in the order of B. External parameters are not compared, because they differ between
/// experiments. Parameters that either calibration holds are not compared.
CommonParameters FindCommonParameters(const CalibrationEstimate& a, const CalibrationEstimate& b);

}  // namespace elastocal
