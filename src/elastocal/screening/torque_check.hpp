// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/calibration/placement.hpp"

namespace elastocal {

/// How the torques of a joint's sensor go with those that the weight of the robot makes.
enum class TorqueContradiction {
  kReversed,   ///< they have the opposite sign
  kScaled,     ///< they are a multiple (or another unit)
  kBiased,     ///< they are off by a constant
  kUnrelated,  ///< they do not follow
  kExchanged,  ///< they follow those of another joint, whose sensor's follow this one's
};

struct ContradictoryTorque {
  int joint = 0;
  TorqueContradiction kind = TorqueContradiction::kUnrelated;
  double slope = 0.0;  ///< of measured torque by that of statics
  double bias = 0.0;   ///< mean of measured less static torque, N.m or N
  int other = -1;      ///< joint that the sensor is exchanged with
};

/// Torque sensors that contradict statics in the postures of a recording of trials, by far more
/// than masses of links, friction and deflection could make them: a slope below 0.5 or above 2 (1.5
/// where the sensors next to it on its limb have none, and all follow), a bias of more than 10 N.m
/// (N) and a quarter of the largest torque, a correlation below a half; or two sensors that fit
/// each other's statics far better than their own (a quarter of the squares). Where all sensors
/// together fit far better with the opposite sign, all are reversed: of those whose load varies
/// little, none by itself would be found. So are all scaled where three quarters of three sensors
/// and more have one factor of 1.5 and more, or its inverse, within a quarter: masses are not all
/// off by as much. Statics of the joints of a leg on one foot, of the others in any posture, at
/// nominal geometry; the waist as its markers have it. Only sensors whose static torque varies by 5
/// N.m (N) or more (sd; for a bias: any; 1 where they follow it reversed, with a correlation of
/// 0.9) in five postures or more are judged; with less, in ten postures or more, only whether they
/// are reversed or do not follow at all, where their scatter leaves the slope certain to a tenth.
/// None where the robot description has no masses.
std::vector<ContradictoryTorque> FindContradictoryTorques(const ErrorModel& model,
                                                          const Recording& recording,
                                                          double slip_m);

/// "leg_left_4_joint: its torques have the opposite sign of those of statics".
std::string Describe(const ContradictoryTorque& found, const RobotTree& tree);

/// Takes the torques of these joints for not measured: statics takes their place.
void HideTorques(const std::vector<ContradictoryTorque>& found, Recording& recording);

}  // namespace elastocal
