// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/measurement/trial_clock.hpp"

namespace elastocal {

/// What is wrong with the columns of a joint log.
struct LogMistake {
  int column = 0;  ///< index into the log's joints
  /// The column with which `column` is exchanged. If it is `column` itself, the sign of `column` is
  /// reversed, or its positions are frozen.
  int exchanged = 0;
  double peak = 0.0;  ///< correlation of speeds (ClockFit) once the mistake is undone
  double frozen_from_s = 0.0, frozen_to_s = 0.0;  ///< robot time; equal if nothing is frozen
  /// If not 0, the columns from `column` to `exchanged` are shifted in a ring: each joint's
  /// positions are in the column that is so many further.
  int moved = 0;
};

/// Finds what is wrong with the columns of a log whose clock cannot be told. `clock` is the clock
/// by the log as it is; if its correlation is above 0.999, nothing is tried.
///
/// These mistakes are tried: the reversed sign of one joint, two exchanged joints, and three or
/// more neighbouring columns of one limb that are all shifted by one. Once undone, a mistake must
/// make the clock reliable, with a correlation of at least 0.9 that lacks at most a quarter of what
/// that of `clock` lacks to 1. Speeds do not tell which of two joints with parallel axes is
/// reversed, nor the direction of a motion there and back. Of the six mistakes with the best
/// correlations, the one with the smallest residuals of positions (LeftByPositions) is therefore
/// taken, and these must be below 0.9 times those of the log as it is.
///
/// A joint is frozen if its logged position changes by less than 2e-5 rad (m) for 2 s or more,
/// while the other joints move by 0.5 rad (m) in all. The rest of the log must tell the clock as
/// well as above, with smaller residuals of positions, and by this clock the correlation in the
/// frozen part must be at most 0.9: joints that are moved one after the other also stand still for
/// long. A frozen joint is returned if its correlation is better than that of the other mistakes.
///
/// `speeds` is `measured` of EstimateTrialClock; `markers` to `coordinates` are as for
/// PredictSpeeds. Signs, exchanges and frozen positions are tried only of joints that move by more
/// than 0.05 rad (m) and are between the root link and a marker.
std::optional<LogMistake> FindLogMistake(const MarkedRobot& robot, const std::vector<int>& markers,
                                         const std::vector<int>& standing, const SmoothedLog& log,
                                         const std::vector<int>& coordinates,
                                         const Eigen::MatrixXd& speeds,
                                         const MarkerTrajectories& trajectories,
                                         const std::optional<double>& expected_lag_s,
                                         const ClockOptions& options, const ClockFit& clock);

/// Name of a mistake as a correction is stated: "sign:arm_7_joint", "exchange:a,b", "frozen:a".
/// `names` are the names of the columns.
std::string NameOf(const LogMistake& mistake, const std::vector<std::string>& names);

/// The reversed signs and exchanged columns among the named mistakes (NameOf).
std::vector<LogMistake> MistakesOf(const std::vector<std::string>& mistakes,
                                   const std::vector<std::string>& names);

/// The log with a mistake undone: a sign reversed, two joints exchanged or columns shifted back. A
/// frozen joint cannot be undone; the log then stays as it is.
SmoothedLog WithoutMistake(SmoothedLog log, const LogMistake& mistake);

/// One sentence about two joints whose columns are copies of each other, number for number, and
/// move; empty if there are none.
std::string DescribeCopies(const SmoothedLog& log, const std::vector<std::string>& names);

/// "with the sign of arm_7_joint reversed the log fits (correlation 0.99)"; `names`: of the
/// columns.
std::string Describe(const LogMistake& mistake, const std::vector<std::string>& names);

}  // namespace elastocal
