// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/recorded/measurements.hpp"

namespace elastocal {

/// Trials with exactly the same numbers as another one, or with a file of the same contents, of
/// which other samples may have been taken: copied, or listed under two names.
struct RepeatedTrials {
  std::vector<std::string> estimated_twice;  ///< pairs of trials for calibration, in words
  /// Trials for validation that the estimate has also used, in words.
  std::vector<std::string> judged_by_estimated;
};

/// Compares samples, and the files that `measured.trials` name, where they are still there.
RepeatedTrials FindRepeatedTrials(const Measurements& measured);

}  // namespace elastocal
