// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/calibration/placement.hpp"

namespace elastocal {

/// Static and measured torques of one joint, N.m or N, with the postures in which they were
/// measured.
struct TorquePairs {
  std::vector<double> expected, measured;
  std::vector<int> posture;
  double weight = 0.0;  ///< largest weight that the joint carried, N
};

/// Pairs measured torques with those of statics at nominal geometry, by joint; the waist is as in
/// `placement`. Joints between the root and a foot are left out where several feet stand, because
/// statics does not tell how these share the load.
std::vector<TorquePairs> PairTorques(const ErrorModel& model, const Recording& recording,
                                     const Placement& placement);

/// Relative disagreement between a leg's torque sensors and statics by the masses of the robot
/// description, in postures on this leg alone: root mean square of the difference over that of the
/// measured torques, all joints together. It contains gains and biases of the sensors, friction and
/// wrong masses, and so tells how uncertain the leg's load is. Infinite where nothing was measured.
double TorqueDisagreement(const ErrorModel& model, const Recording& recording,
                          const Placement& placement, int leg);

}  // namespace elastocal
