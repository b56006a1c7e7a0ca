#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/labels.hpp"
#include "elastocal/measurement/trial.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// What measurements have to know of a robot: all of a project's markers stand here, in its order,
/// and "marker m" below is the m-th of them.
struct MarkedRobot {
  RobotTree tree;
  std::vector<Marker> markers;         ///< at their nominal positions
  std::vector<LabelCluster> clusters;  ///< of `markers`
  std::vector<int> torque_sensors;     ///< joints whose logged torques are measured
  Eigen::VectorXd q_not_logged;        ///< coordinates, rad or m: where joints not logged stood
};

/// Coordinate of the robot tree of each joint of a log. Throws InputError for a joint that the
/// robot does not have.
std::vector<int> LoggedCoordinates(const RobotTree& tree, const JointLog& log);

}  // namespace elastocal
