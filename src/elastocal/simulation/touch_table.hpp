// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/moving_chain.hpp"
#include "elastocal/simulation/virtual_robot.hpp"

namespace elastocal {

/// How a hand lays its plate on a table: by the forces that a sensor in the wrist measures
/// (admittance control), without knowing where the table is.
struct TouchOptions {
  double force = 20.0;        ///< with which it presses in the end, N
  double approach = 0.06;     ///< m/s
  double largest_turn = 0.1;  ///< rad/s
  double longest_s = 15.0;    ///< until it gives up
};

/// A table's plane that a hand touched. `flush`: the force is within a fifth of what was wanted,
/// and acts in the middle half of the plate, so that all of it touches.
struct Touch {
  bool flush = false;
  double time_s = 0.0;
};

/// Lowers the plate of a virtual robot along its normal until it touches, and then moves it by the
/// force and the moments of the contact until it lies flush. The joints of `arm`, a nominal robot
/// that holds everything else where it is, are commanded by the nominal Jacobian; `command`, by
/// coordinate, is where they begin and end.
Touch TouchTable(VirtualRobot& robot, int plate, const PhysicalPlate& described, MovingChain& arm,
                 const TouchOptions& options, Eigen::VectorXd& command);

/// Moves the nominal plate by a displacement [m] and a rotation vector [rad] in its own axes, to
/// first order: the joints of `arm` in `command` take the shortest step, damped near singular
/// postures and within their limits.
void MovePlate(const PhysicalPlate& described, const Vector6d& by, MovingChain& arm,
               Eigen::VectorXd& command);

}  // namespace elastocal
