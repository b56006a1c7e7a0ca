// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/calibration/placement.hpp"

namespace elastocal {

/// Static and measured torques of one joint, N.m or N, by the posture in which they were measured.
struct TorquePairs {
  std::vector<double> expected, measured;
  std::vector<int> posture;
  double weight = 0.0;  ///< the largest that the joint carried, N
};

/// By joint: measured torques and those of statics at nominal geometry, with the waist where its
/// markers have it. Not of a joint between the root and a foot where several feet stand: how they
/// share the load, statics does not say.
std::vector<TorquePairs> PairTorques(const ErrorModel& model, const Recording& recording,
                                     const Placement& placement);

/// How far the torques of a leg's sensors are from those that statics makes of the masses of the
/// robot description, in postures on this leg alone: root mean square of the difference over that
/// of the torques, all joints together. Gains and biases of the sensors, friction and wrong masses
/// are in it: what is not known of the leg's load. Infinite where nothing was measured.
double TorqueDisagreement(const ErrorModel& model, const Recording& recording,
                          const Placement& placement, int leg);

}  // namespace elastocal
