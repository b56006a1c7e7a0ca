// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// What is wrong with a torque sensor.
enum class TorqueFault {
  kDead,       ///< the same value throughout the log
  kStuck,      ///< the same value for seconds while the robot moved
  kSaturated,  ///< stays at its own highest or lowest value while the robot moved
};

struct TorqueFinding {
  int column = 0;  ///< of the log's torques
  TorqueFault fault = TorqueFault::kDead;
  double value = 0.0;    ///< value at which the sensor stays, N.m or N
  double share = 0.0;    ///< share of the log's samples with exactly this value
  double begin_s = 0.0;  ///< robot time at which it begins to stay there
};

struct TorqueCheckOptions {
  double moved_rad = 0.02;  ///< the robot moves if a joint moves by this much (prismatic: m)
  double shortest_stay_s =
      0.25;  ///< shorter stays do not count: they may be values held between updates
  double saturated_s = 0.5;  ///< time at an extreme value that cannot be chance
  double stuck_s = 5.0;      ///< the same for a value between the extremes
};

/// Finds torque sensors that cannot be trusted, by their raw values: a working sensor never reads
/// exactly the same value for long while the robot moves. Returns at most one finding for each
/// sensor, the first that applies in the order of TorqueFault. Joints without torques are skipped.
std::vector<TorqueFinding> CheckTorqueSensors(const JointLog& log,
                                              const TorqueCheckOptions& options);

/// "dead (0 N.m throughout)", for a report.
std::string Describe(const TorqueFinding& finding);

}  // namespace elastocal
