// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "elastocal/measurement/clock.hpp"
#include "elastocal/measurement/marked_robot.hpp"
#include "elastocal/measurement/smoothed_log.hpp"
#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// Refines lag and drift of a clock by marker positions. `by_speed` is the clock that the speeds
/// tell within some hundredths of a second. The positions are those of the markers `markers` in
/// `trajectories`, whose frame is one in which the links `standing` do not move. `coordinates` are
/// the coordinates of the log's joints.
///
/// Errors of the robot explain little of a speed, because it is a scalar: the residuals of speeds
/// limit the lag to several milliseconds in slow motion. Positions allow a model of these errors.
/// Each joint that moves has six unknown errors of its mounting, each marker has an unknown
/// displacement, and each revolute joint with a torque sensor has an unknown compliance, all with
/// priors of the size that such errors have in robots. FindLagChange estimates the lag together
/// with them.
///
/// The state is kReliable if the new standard deviation is at most ClockOptions::largest_sd_s, and
/// kImprecise otherwise. Returns `by_speed` if FindLagChange finds nothing, or if the new standard
/// deviation is not smaller.
///
/// If two lags explain the speeds about as well (ClockState::kAmbiguous), both are refined. Returns
/// the one whose residuals of positions are less than half of the other's, or the only one that can
/// be refined, or `by_speed` if there is neither.
ClockFit RefineClock(const MarkedRobot& robot, const std::vector<int>& markers,
                     const std::vector<int>& standing, const SmoothedLog& log,
                     const std::vector<int>& coordinates, const MarkerTrajectories& trajectories,
                     const ClockFit& by_speed, const ClockOptions& options);

/// Root mean square difference between the measured coordinates of the markers and those that the
/// nominal robot predicts from the log at this clock, m. One rigid transform places the cameras'
/// frame for the whole trial. Arguments as for RefineClock. Infinite if cameras and log share no
/// moment.
double LeftByPositions(const MarkedRobot& robot, const std::vector<int>& markers,
                       const std::vector<int>& standing, const SmoothedLog& log,
                       const std::vector<int>& coordinates, const MarkerTrajectories& trajectories,
                       const ClockFit& clock);

/// Chooses between the two lags of an ambiguous clock (ClockState::kAmbiguous): the one at which
/// LeftByPositions is less than half of what it is at the other. Nothing if neither is. Unlike
/// RefineClock, this works on trials that move only from one posture to the next.
std::optional<double> LagByPositions(const MarkedRobot& robot, const std::vector<int>& markers,
                                     const std::vector<int>& standing, const SmoothedLog& log,
                                     const std::vector<int>& coordinates,
                                     const MarkerTrajectories& trajectories, const ClockFit& clock);

}  // namespace elastocal
