// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/gaps.hpp"
#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// A piece of a log without holes, at a constant rate and low-passed.
struct LogPiece {
  double start_s = 0.0;  ///< robot time of the first sample
  double rate_hz = 0.0;
  Eigen::MatrixXd values;  ///< samples x signals, columns as in SmoothedLog

  double end_s() const { return start_s + static_cast<double>(values.rows() - 1) / rate_hz; }
};

/// The signals of a joint log, with the same filter as the markers (paper, section 5.1), so that
/// positions, torques and markers show the same motion with the same amplitude and phase.
struct SmoothedLog {
  int joints = 0;
  int wrench_sensors = 0;
  /// The columns of `values` are the positions of all joints, then their torques (NaN without
  /// torque sensor), then six columns for each wrench sensor.
  std::vector<LogPiece> pieces;  ///< in order; there is a hole between two of them
  double margin_s = 0.0;         ///< length at either end of a piece that is not used

  /// All signals at a robot time, by the cubic through the four samples around it. Nothing outside
  /// the pieces or in their margins, where the filter knows only one side.
  std::optional<Eigen::VectorXd> At(double robot_time_s) const;

  /// Whether At() has a value.
  bool Covers(double robot_time_s) const { return PieceAt(robot_time_s) != nullptr; }

 private:
  const LogPiece* PieceAt(double robot_time_s) const;
};

/// Splits the log at holes of more than 0.1 s (or two samples), brings each piece to a constant
/// rate (its own mean rate, by linear interpolation; a regular log stays as it is) and filters it
/// forwards and backwards. Leaves out pieces that are too short for the filter. Time is linear in
/// the number of samples.
///
/// Throws InputError, naming the log, if its rate is less than twice the cutoff.
SmoothedLog SmoothLog(const JointLog& log, const SmoothingOptions& options);

}  // namespace elastocal
