// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/recorded/measurements.hpp"

namespace elastocal {

/// Trials with exactly the same numbers as another one: copied, or listed under two names.
struct RepeatedTrials {
  std::vector<std::string> estimated_twice;  ///< pairs of trials for calibration, in words
  /// Trials for validation that the estimate has also used, in words.
  std::vector<std::string> judged_by_estimated;
};

RepeatedTrials FindRepeatedTrials(const Measurements& measured);

}  // namespace elastocal
