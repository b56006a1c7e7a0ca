// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/observation/observed_robot.hpp"

namespace elastocal {

/// Places the feet that are not `placed` (one entry a foot) by nominal kinematics relative to the
/// first foot: the median over all postures (rows of q), on the same level floor, turned only about
/// its normal. Each foot lies flat on the floor with its attitude of the zero posture with the root
/// link upright. The first foot is the origin.
void PlaceFeet(const RobotTree& tree, const Eigen::MatrixXd& q, const std::vector<char>& placed,
               ObservationSetup& setup);

/// The plate that touches in each posture: the one that lies flattest by nominal kinematics. Throws
/// InputError (which names `source`) where the flattest plate is more than 20 degrees from level in
/// the median of the postures; the message says so if the plates seem to be upside down.
std::vector<int> FindTouchingPlates(const RobotTree& tree, const ObservationSetup& setup,
                                    const Eigen::MatrixXd& q, const std::string& source);

/// Throws InputError where a plate lies upside down by nominal kinematics in most of its touches.
/// `plates` says which plate touches in each posture; -1: none.
void CheckNamedPlates(const RobotTree& tree, const ObservationSetup& setup,
                      const Eigen::MatrixXd& q, const std::vector<int>& plates,
                      const std::string& source);

/// Whether the closure of the legs tells anything about the robot, in postures that are rows of q.
struct ClosureEvidence {
  int postures = 0;
  /// Number of postures in which nominal kinematics closes to 0.1 mm and 0.01 degrees.
  int exact = 0;
  double median = 0.0;  ///< median distance that nominal kinematics leaves, m
  /// If most are exact, the encoder values come from a planner that closed the loop with the
  /// nominal model. A residual that nominal kinematics makes zero tells nothing.
  bool planned() const { return 2 * exact > postures; }
};
ClosureEvidence CheckClosure(const ObservedRobot& model, const Eigen::MatrixXd& q);

/// The result as a sentence for users.
std::string DescribeClosure(const ClosureEvidence& closure);

}  // namespace elastocal
