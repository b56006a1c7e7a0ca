// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/calibration/placement.hpp"

namespace elastocal {

/// Contradictions between the torques of a joint's sensor and those that the weight of the robot
/// causes.
enum class TorqueContradiction {
  kReversed,   ///< torques have the opposite sign
  kScaled,     ///< torques are a multiple of the expected ones (or in another unit)
  kBiased,     ///< torques have a constant offset
  kUnrelated,  ///< torques do not follow the expected ones
  kExchanged,  ///< torques follow those of another joint, whose sensor follows this joint's
};

/// A torque sensor that contradicts statics.
struct ContradictoryTorque {
  int joint = 0;
  TorqueContradiction kind = TorqueContradiction::kUnrelated;
  double slope = 0.0;  ///< slope of measured over static torques
  double bias = 0.0;   ///< mean of measured minus static torque, N.m or N
  int other = -1;      ///< joint with which the sensor is exchanged
};

/// Finds torque sensors that contradict statics in the postures of a recording of trials by far
/// more than masses of links, friction and deflection explain. Empty where the robot description
/// has no masses. A single sensor contradicts by
///
/// - a slope below 0.5 or above 2 (1.5 if the sensors next to it on its limb follow statics without
///   such a factor);
/// - a bias of more than 10 N.m (N) and more than a quarter of the largest torque;
/// - a correlation below a half;
/// - another sensor with which it is exchanged: the two fit each other's statics far better than
///   their own (a quarter of the squares).
///
/// All sensors are reversed if together they fit far better with the opposite sign; where the load
/// varies little, no single one would be found. All are scaled if three quarters of at least three
/// sensors have one factor of at least 1.5, or its inverse, within a quarter, because not all
/// masses are off by as much.
///
/// Statics is computed at nominal geometry, with the waist placed by its markers: for joints of a
/// leg in postures on one foot, for the others in any posture. A sensor is judged if its static
/// torque varies by at least 5 N.m (N) (sd; for a bias by any amount; 1 if it follows statics
/// reversed with a correlation of 0.9) in at least five postures. With less variation, in at least
/// ten postures, only a reversed or unrelated sensor is found, if its scatter determines the slope
/// to a tenth.
std::vector<ContradictoryTorque> FindContradictoryTorques(const ErrorModel& model,
                                                          const Recording& recording,
                                                          double slip_m);

/// Text such as "leg_left_4_joint: its torques have the opposite sign of those of statics".
std::string Describe(const ContradictoryTorque& found, const RobotTree& tree);

/// Marks the torques of these joints as not measured, so that statics replaces them.
void HideTorques(const std::vector<ContradictoryTorque>& found, Recording& recording);

}  // namespace elastocal
