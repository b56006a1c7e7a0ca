// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// What the cameras recorded: positions of labelled markers at a constant rate.
struct MarkerTrajectories {
  std::string source;              ///< the file, for messages
  std::vector<std::string> names;  ///< of the markers, in the order of `positions`
  double rate_hz = 0.0;
  /// frames x 3 N_M, m, in the camera frame; NaN (all three) where a marker was not seen. Frame i
  /// was taken at i / rate_hz on the cameras' clock.
  Eigen::MatrixXd positions;

  int frame_count() const { return static_cast<int>(positions.rows()); }
  int marker_count() const { return static_cast<int>(names.size()); }
};

/// A sensor that measures the force and moment between a link and what it touches.
struct ForceTorqueSensor {
  std::string name;
  int link = 0;  ///< of the robot tree
};

/// What the robot recorded, on its own clock.
struct JointLog {
  std::string source;
  std::vector<std::string> names;  ///< of the joints, in the order of the columns
  Eigen::VectorXd time_s;          ///< strictly increasing, of the robot's clock
  Eigen::MatrixXd positions;       ///< samples x joints, rad or m
  Eigen::MatrixXd torques;         ///< samples x joints, N.m or N; NaN for joints without sensor
  std::vector<ForceTorqueSensor> wrench_sensors = {};
  Eigen::MatrixXd wrenches =
      {};  ///< samples x 6 for each sensor: force [N], moment [N.m], as in Recording

  int sample_count() const { return static_cast<int>(time_s.size()); }
};

}  // namespace elastocal
