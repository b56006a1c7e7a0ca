// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "elastocal/measurement/clock.hpp"
#include "elastocal/measurement/marked_robot.hpp"
#include "elastocal/measurement/smoothed_log.hpp"
#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// Lag and drift of a clock that the speeds tell within some hundredths of a second (`by_speed`),
/// by the positions of the markers `markers`, as `trajectories` has them in a frame in which the
/// links `standing` do not move. `coordinates`: of the log's joints.
///
/// Speeds are scalars, of which errors of the robot explain little: their remainder limits the lag
/// to several milliseconds in slow motion. Here each joint that moves may be mounted otherwise (six
/// numbers) and each marker sit elsewhere, within what robots are off, and each joint with a torque
/// sensor may give way to its torque; only what none of this explains is left (FindLagChange). The
/// result is judged by the same bound (ClockOptions::largest_sd_s); `by_speed` itself where it is
/// no better.
///
/// Where two lags explain the speeds about as well (ClockState::kAmbiguous), it is the one at which
/// the positions leave less than half; `by_speed` itself where neither does.
ClockFit RefineClock(const MarkedRobot& robot, const std::vector<int>& markers,
                     const std::vector<int>& standing, const SmoothedLog& log,
                     const std::vector<int>& coordinates, const MarkerTrajectories& trajectories,
                     const ClockFit& by_speed, const ClockOptions& options);

/// How far the markers are from where the nominal robot has them by the log at this clock, root
/// mean square of a coordinate, m: the cameras' frame is placed once for the whole trial. Arguments
/// as for RefineClock; infinite where cameras and log share no moment.
double LeftByPositions(const MarkedRobot& robot, const std::vector<int>& markers,
                       const std::vector<int>& standing, const SmoothedLog& log,
                       const std::vector<int>& coordinates, const MarkerTrajectories& trajectories,
                       const ClockFit& clock);

/// Of the two lags of an ambiguous clock (ClockState::kAmbiguous), the one at which positions leave
/// less than half of what they leave at the other (LeftByPositions); none where neither does. It
/// takes no more motion than that from one posture to the next, which RefineClock cannot do with.
std::optional<double> LagByPositions(const MarkedRobot& robot, const std::vector<int>& markers,
                                     const std::vector<int>& standing, const SmoothedLog& log,
                                     const std::vector<int>& coordinates,
                                     const MarkerTrajectories& trajectories, const ClockFit& clock);

}  // namespace elastocal
