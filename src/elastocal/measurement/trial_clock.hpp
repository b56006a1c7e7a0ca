// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/clock.hpp"
#include "elastocal/measurement/marked_robot.hpp"
#include "elastocal/measurement/smoothed_log.hpp"

namespace elastocal {

/// Speeds of markers by the robot's log.
struct LoggedSpeeds {
  Eigen::VectorXd time_s;  ///< robot time, strictly increasing
  Eigen::MatrixXd speeds;  ///< times x markers, m/s
};

/// Speeds of the markers `markers` relative to the links `standing`, by nominal forward kinematics
/// of the logged joint positions `log` (whose columns are the coordinates `coordinates`), about
/// `rate_hz` times a second. If these are at rest in the laboratory, cameras see the same speeds,
/// whatever their frame. If one or two links stand, the first does not move. If three or more do,
/// their origins do not, as far as nominal kinematics allows: feet that are balls roll, and what is
/// above them turns about their centres.
LoggedSpeeds PredictSpeeds(const MarkedRobot& robot, const std::vector<int>& markers,
                           const std::vector<int>& standing, const SmoothedLog& log,
                           const std::vector<int>& coordinates, double rate_hz);

/// Mean speeds over the markers that are seen for half of the trial or more, and the range of lags
/// to search.
struct MeanSpeeds {
  MeasuredSpeed measured;
  PredictedSpeed logged;
  ClockOptions options;
};

/// The mean speeds that the first search of EstimateTrialClock compares; arguments as there.
/// Nothing if there are no data.
std::optional<MeanSpeeds> TakeMeanSpeeds(const Eigen::MatrixXd& measured, double rate_hz,
                                         LoggedSpeeds logged,
                                         const std::optional<double>& expected_lag_s,
                                         ClockOptions options);

/// Estimates lag and drift of the robot's clock from the mean speed of all markers (section 5.1).
/// `measured` (frames x markers, m/s, NaN where unknown; markers as in `logged`) must have passed
/// the same filter as the log.
///
/// The mean changes when markers come and go. The clock is therefore estimated a second time, with
/// both means over the markers that the cameras saw at each moment.
///
/// Without `expected_lag_s`, the search covers the lags from both beginning together to both ending
/// together (at most ten minutes), and ClockOptions::longest_lag_s further to either side.
ClockFit EstimateTrialClock(const Eigen::MatrixXd& measured, double rate_hz, LoggedSpeeds logged,
                            const std::optional<double>& expected_lag_s, ClockOptions options);

}  // namespace elastocal
