// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/observation/observed_robot.hpp"

namespace elastocal {

/// Places the feet that are not `placed` (one a foot) where nominal kinematics sees them from the
/// first foot: in the median of all postures (rows of q), on the same level floor, turned about its
/// normal. The attitude of each foot flat on the floor is that of the zero posture with the root
/// link upright; the first foot is the origin.
void PlaceFeet(const RobotTree& tree, const Eigen::MatrixXd& q, const std::vector<char>& placed,
               ObservationSetup& setup);

/// Which plate touches in each posture: the one that nominal kinematics puts flattest. Throws
/// InputError where in most postures of `source` no plate is within 20 degrees of level, and says
/// so if the plates seem to be upside down.
std::vector<int> FindTouchingPlates(const RobotTree& tree, const ObservationSetup& setup,
                                    const Eigen::MatrixXd& q, const std::string& source);

/// Throws InputError where a plate lies upside down by nominal kinematics in most of its touches.
/// `plates`: which one touches in each posture; -1: none.
void CheckNamedPlates(const RobotTree& tree, const ObservationSetup& setup,
                      const Eigen::MatrixXd& q, const std::vector<int>& plates,
                      const std::string& source);

/// Whether the closure of the feet says anything about the robot, in postures that are rows of q.
struct ClosureEvidence {
  int postures = 0;
  int exact = 0;        ///< in which nominal kinematics closes it to 0.1 mm and 0.01 degrees
  double median = 0.0;  ///< of the distance that nominal kinematics leaves, m
  /// Where most are exact, the encoders follow a planner that closed the loop with the nominal
  /// model: a residual that nominal kinematics makes zero tells nothing.
  bool planned() const { return 2 * exact > postures; }
};
ClosureEvidence CheckClosure(const ObservedRobot& model, const Eigen::MatrixXd& q);

/// What was found, as a sentence for users.
std::string DescribeClosure(const ClosureEvidence& closure);

}  // namespace elastocal
