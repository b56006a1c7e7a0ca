// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "elastocal/measurement/trial_clock.hpp"

namespace elastocal {

/// What is wrong with the times of a joint log.
struct ClockMistake {
  double rate = 1.0;    ///< true time over the log's time; above 1 if rows are missing
  double jump_s = 0.0;  ///< the log's clock jumps forward by this; 0: its rate is wrong instead
  double at_s = 0.0;    ///< robot time of the jump
  double peak = 0.0;    ///< correlation of the speeds once the mistake is undone
};

/// Finds what is wrong with the log's clock in a trial whose clock cannot be told: another rate
/// (within 20 % of 1 or, if none of these fits, 0.5 or 2) or one jump of at least 0.1 s. `peak` is
/// the correlation of the speeds with the log as it is. With the mistake undone, the correlation is
/// at least 0.9 and lacks at most a quarter of what `peak` lacks to 1. If both a rate and a jump
/// fit, the one with the higher correlation is returned.
std::optional<ClockMistake> FindClockMistake(const MeanSpeeds& speeds, double peak);

/// "if the log's clock ran 5.3 % slow, the log fits (correlation 0.97): rows may be missing, or its
/// rate is another".
std::string Describe(const ClockMistake& mistake);

}  // namespace elastocal
