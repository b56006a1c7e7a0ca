#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/clock.hpp"
#include "elastocal/measurement/marked_robot.hpp"
#include "elastocal/measurement/smoothed_log.hpp"

namespace elastocal {

/// Speeds of markers as the robot's log has them.
struct LoggedSpeeds {
  Eigen::VectorXd time_s;  ///< robot time, strictly increasing
  Eigen::MatrixXd speeds;  ///< times x markers, m/s
};

/// Speeds of the markers `markers` relative to the link `standing`, by nominal forward kinematics
/// of the logged joint positions `log` (whose columns are the coordinates `coordinates`), about
/// `rate_hz` times a second. With `standing` at rest in the laboratory these are the speeds that
/// cameras see, wherever they stand: no frame of theirs enters.
LoggedSpeeds PredictSpeeds(const MarkedRobot& robot, const std::vector<int>& markers, int standing,
                           const SmoothedLog& log, const std::vector<int>& coordinates,
                           double rate_hz);

/// Lag and drift of the robot's clock from the mean speed of all markers (section 5.1; the sum over
/// markers of one robot has no periods of its own and no frame). `measured` (frames x markers, m/s,
/// NaN where unknown; markers as in `logged`) was filtered as the log was.
///
/// Markers come and go, and with them the mean. So the clock is estimated again, in each moment
/// with those markers that the cameras saw then.
///
/// Without `expected_lag_s`, the lags searched are those between both beginning together and both
/// ending together (ten minutes at most), and ClockOptions::longest_lag_s further to either side.
ClockFit EstimateTrialClock(const Eigen::MatrixXd& measured, double rate_hz, LoggedSpeeds logged,
                            const std::optional<double>& expected_lag_s, ClockOptions options);

}  // namespace elastocal
