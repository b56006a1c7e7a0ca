#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/gaps.hpp"
#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// A log without holes, at a constant rate, low-passed.
struct LogPiece {
  double start_s = 0.0;  ///< robot time of the first sample
  double rate_hz = 0.0;
  Eigen::MatrixXd values;  ///< samples x signals, as SmoothedLog

  double end_s() const { return start_s + static_cast<double>(values.rows() - 1) / rate_hz; }
};

/// The signals of a joint log, filtered as the markers are (paper, section 5.1): positions, torques
/// and markers then show the same motion with the same amplitude and phase.
struct SmoothedLog {
  int joints = 0;
  int wrench_sensors = 0;
  /// The columns of `values` are the positions and then the torques of all joints, then six a
  /// wrench sensor; NaN for joints without torque sensor.
  std::vector<LogPiece> pieces;  ///< in order, with a hole between each two
  double margin_s = 0.0;         ///< at the ends of a piece, within which it is not used

  /// All signals at a robot time, by the cubic through the four samples around it; nothing outside
  /// the pieces or in their margins, where the filter knows only one side.
  std::optional<Eigen::VectorXd> At(double robot_time_s) const;

  /// Whether At() has a value.
  bool Covers(double robot_time_s) const { return PieceAt(robot_time_s) != nullptr; }

 private:
  const LogPiece* PieceAt(double robot_time_s) const;
};

/// Splits the log at holes of more than 0.1 s (or two samples), brings each piece to a constant
/// rate (its own mean rate, by linear interpolation; a regular log stays as it is) and filters it
/// forwards and backwards. Pieces too short for the filter are dropped. Linear in the number of
/// samples.
///
/// Throws InputError naming the log if it is slower than twice the cutoff.
SmoothedLog SmoothLog(const JointLog& log, const SmoothingOptions& options);

}  // namespace elastocal
