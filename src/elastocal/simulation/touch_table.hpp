// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/moving_chain.hpp"
#include "elastocal/simulation/virtual_robot.hpp"

namespace elastocal {

/// How a hand lays its plate on a table. It is led by the forces that a sensor in the wrist
/// measures (admittance control) and does not know where the table is.
struct TouchOptions {
  double force = 20.0;        ///< force with which it presses in the end, N
  double approach = 0.06;     ///< speed before it meets the table, m/s
  double largest_turn = 0.1;  ///< largest angular velocity about each axis, rad/s
  double longest_s = 15.0;    ///< time after which it gives up
};

/// Result of laying a plate on a table.
struct Touch {
  /// Whether the plate lay flush for 0.3 s: the force is within a fifth of the wanted one, and acts
  /// in the middle half of the plate, so that all of the plate touches.
  bool flush = false;
  double time_s = 0.0;  ///< duration
};

/// Lowers the plate of a virtual robot along its normal until it touches, and then moves it by the
/// force and the moments of the contact until it lies flush. The joints of `arm` (a nominal robot
/// in which all else rests) are commanded by the nominal Jacobian. `command` (by coordinate) is the
/// posture in which they begin, and is set to the one in which they end.
Touch TouchTable(VirtualRobot& robot, int plate, const PhysicalPlate& described, MovingChain& arm,
                 const TouchOptions& options, Eigen::VectorXd& command);

/// Moves the nominal plate by a displacement [m] and a rotation vector [rad] in its own axes, to
/// first order: the joints of `arm` in `command` take the shortest step, damped near singular
/// postures and within their limits.
void MovePlate(const PhysicalPlate& described, const Vector6d& by, MovingChain& arm,
               Eigen::VectorXd& command);

}  // namespace elastocal
