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
  double value = 0.0;    ///< at which it stays, N.m or N
  double share = 0.0;    ///< of the log's samples that are exactly this value
  double begin_s = 0.0;  ///< robot time at which it begins to stay there
};

struct TorqueCheckOptions {
  double moved_rad = 0.02;        ///< a joint (prismatic: m) that moves this much moves the robot
  double shortest_stay_s = 0.25;  ///< stays count from here on; data held between updates do not
  double saturated_s = 0.5;       ///< time in stays at an extreme that is no chance
  double stuck_s = 5.0;           ///< the same for a value between the extremes
};

/// Torque sensors that cannot be trusted, by their own raw values: what a working sensor reads is
/// never exactly the same for long while the robot moves. At most one finding a sensor, the first
/// that applies in the order of TorqueFault. Joints without torques are passed over.
std::vector<TorqueFinding> CheckTorqueSensors(const JointLog& log,
                                              const TorqueCheckOptions& options);

/// "dead (0 N.m throughout)", for a report.
std::string Describe(const TorqueFinding& finding);

}  // namespace elastocal
