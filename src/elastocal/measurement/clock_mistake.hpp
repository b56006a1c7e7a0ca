// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "elastocal/measurement/trial_clock.hpp"

namespace elastocal {

/// What is wrong with the times of a joint log.
struct ClockMistake {
  double rate = 1.0;    ///< time that passed by time of the log: above 1 where rows are missing
  double jump_s = 0.0;  ///< the log's clock jumps forward by this; 0: it has another rate
  double at_s = 0.0;    ///< where, robot time
  double peak = 0.0;    ///< correlation of the speeds once that is undone
};

/// What is wrong with the log's clock in a trial whose clock cannot be told: the rate (0.5, 2, or
/// within a fifth of 1) or the one jump with which speeds correlate far better than with the log as
/// it is (`peak`). A rate comes before a jump.
std::optional<ClockMistake> FindClockMistake(const MeanSpeeds& speeds, double peak);

/// "if the log's clock ran 5.3 % slow, the log fits (correlation 0.97): rows may be missing, or its
/// rate is another".
std::string Describe(const ClockMistake& mistake);

}  // namespace elastocal
