// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/log_mistake.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>

namespace elastocal {
namespace {

constexpr double kLeastMotion = 0.05;  // rad or m: range of a joint that can be wrong
constexpr double kLeastPeak = 0.9;     // what is right correlates well
constexpr double kFarBetter = 0.25;    // of what a correlation lacks to one is left

/// Joints that move and are between the standing link and a marker.
std::vector<int> MovingColumns(const MarkedRobot& robot, const std::vector<int>& markers,
                               const SmoothedLog& log, const std::vector<int>& coordinates) {
  std::vector<char> on_way(robot.tree.coordinate_count(), 0);
  for (int m : markers) {
    for (int joint : JointsToBody(robot.tree, robot.tree.links[robot.markers[m].link].body)) {
      on_way[robot.tree.joints[joint].coordinate] = 1;
    }
  }
  std::vector<int> moving;
  for (int c = 0; c < log.joints; ++c) {
    if (on_way[coordinates[c]] == 0) continue;
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -lowest;
    for (const LogPiece& piece : log.pieces) {
      lowest = std::min(lowest, piece.values.col(c).minCoeff());
      highest = std::max(highest, piece.values.col(c).maxCoeff());
    }
    if (highest - lowest > kLeastMotion) moving.push_back(c);
  }
  return moving;
}

}  // namespace

std::optional<LogMistake> FindLogMistake(const MarkedRobot& robot, const std::vector<int>& markers,
                                         const std::vector<int>& standing, const SmoothedLog& log,
                                         const std::vector<int>& coordinates,
                                         const Eigen::MatrixXd& speeds, double rate_hz,
                                         const std::optional<double>& expected_lag_s,
                                         const ClockOptions& options, double peak) {
  const double least_peak = std::max(kLeastPeak, 1.0 - kFarBetter * (1.0 - peak));
  std::optional<LogMistake> best;
  const std::vector<int> columns = MovingColumns(robot, markers, log, coordinates);
  for (std::size_t a = 0; a < columns.size(); ++a) {
    for (std::size_t b = a; b < columns.size(); ++b) {
      SmoothedLog changed = log;
      for (LogPiece& piece : changed.pieces) {
        if (a == b) {
          piece.values.col(columns[a]) *= -1.0;
        } else {
          piece.values.col(columns[a]).swap(piece.values.col(columns[b]));
        }
      }
      const ClockFit fit = EstimateTrialClock(
          speeds, rate_hz, PredictSpeeds(robot, markers, standing, changed, coordinates, rate_hz),
          expected_lag_s, options);
      if (fit.state != ClockState::kReliable || fit.peak < least_peak) continue;
      if (!best || fit.peak > best->peak) best = {columns[a], columns[b], fit.peak};
    }
  }
  return best;
}

std::string Describe(const LogMistake& mistake, const std::vector<std::string>& names) {
  char peak[40];
  std::snprintf(peak, sizeof peak, "(correlation %.4f)", mistake.peak);
  const std::string what =
      mistake.exchanged == mistake.column
          ? "the sign of " + names[mistake.column] + " reversed"
          : names[mistake.column] + " and " + names[mistake.exchanged] + " exchanged";
  return "with " + what + " the log fits " + peak;
}

}  // namespace elastocal
