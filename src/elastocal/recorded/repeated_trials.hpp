// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/recorded/measurements.hpp"

namespace elastocal {

/// Trials that are the same recording as another one, number for number: copied, or listed under
/// two names.
struct RepeatedTrials {
  std::vector<std::string> estimated_twice;      ///< both for calibration, in words
  std::vector<std::string> judged_by_estimated;  ///< for validation what the estimate has used
};

RepeatedTrials FindRepeatedTrials(const Measurements& measured);

}  // namespace elastocal
