// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/labels.hpp"
#include "elastocal/measurement/trial.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// What the processing of measurements needs to know of a robot. It has all markers of the project,
/// in the project's order; in this layer, "marker m" is the m-th of them.
struct MarkedRobot {
  RobotTree tree;
  std::vector<Marker> markers;         ///< at their nominal positions
  std::vector<LabelCluster> clusters;  ///< of `markers`
  std::vector<int> torque_sensors;     ///< joints whose logged torques are measured
  Eigen::VectorXd
      q_not_logged;  ///< for each coordinate, rad or m: positions of joints that are not logged
};

/// For each joint of a log, its coordinate of the robot tree. Throws InputError for a joint that
/// the robot does not have.
std::vector<int> LoggedCoordinates(const RobotTree& tree, const JointLog& log);

}  // namespace elastocal
