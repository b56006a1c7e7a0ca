// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/measurement/trial_clock.hpp"

namespace elastocal {

/// What is wrong with the columns of a joint log.
struct LogMistake {
  int column = 0;     ///< of the log's joints
  int exchanged = 0;  ///< with this one; `column` itself: its sign is reversed, or it is frozen
  double peak = 0.0;  ///< correlation of speeds (ClockFit) once that is undone
  double frozen_from_s = 0.0, frozen_to_s = 0.0;  ///< of the robot's time; equal: it is not
  /// From `column` to `exchanged` each joint has the column of the joint so many further, in a
  /// ring; 0: they are not moved.
  int moved = 0;
};

/// What is wrong with a log whose clock cannot be told: the reversed sign of one joint, exchange of
/// two, or columns of a limb (or of a part of it, three joints and more) all moved by one. Undone,
/// it lets the clock be told, with the best correlation, which must be far better than that of
/// `clock`, which is by the log as it is (a quarter of what it lacks to 1). Speeds do not tell
/// which of two joints with parallel axes turns the other way, nor which way a motion there and
/// back goes (another joint, one posture later, may be as fast); the positions in `trajectories`
/// do, which must leave least, and less than by the log as it is. Or it is a joint that is logged
/// in exactly the same place for two seconds or more, in which others move by half a radian, while
/// the rest of the log tells the clock as well, by which that part is not what the cameras saw
/// (joints that are moved one after the other stand still for long). `speeds` and `logged` as for
/// EstimateTrialClock, `markers` to `coordinates` as for PredictSpeeds. Joints that hardly move are
/// passed over.
std::optional<LogMistake> FindLogMistake(const MarkedRobot& robot, const std::vector<int>& markers,
                                         const std::vector<int>& standing, const SmoothedLog& log,
                                         const std::vector<int>& coordinates,
                                         const Eigen::MatrixXd& speeds,
                                         const MarkerTrajectories& trajectories,
                                         const std::optional<double>& expected_lag_s,
                                         const ClockOptions& options, const ClockFit& clock);

/// "sign:arm_7_joint", "exchange:a,b", "frozen:a"; `names`: of the columns.
std::string NameOf(const LogMistake& mistake, const std::vector<std::string>& names);

/// The signs and exchanges of columns among mistakes of these names.
std::vector<LogMistake> MistakesOf(const std::vector<std::string>& mistakes,
                                   const std::vector<std::string>& names);

/// The log with a sign reversed, two joints exchanged or columns moved back; as it is with a frozen
/// joint.
SmoothedLog WithoutMistake(SmoothedLog log, const LogMistake& mistake);

/// Two joints of these columns that move, and that are logged in the same places, number for
/// number; in words, else empty.
std::string DescribeCopies(const SmoothedLog& log, const std::vector<std::string>& names);

/// "with the sign of arm_7_joint reversed the log fits (correlation 0.99)"; `names`: of the
/// columns.
std::string Describe(const LogMistake& mistake, const std::vector<std::string>& names);

}  // namespace elastocal
