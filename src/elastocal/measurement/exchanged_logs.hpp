// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "elastocal/measurement/trial_samples.hpp"

namespace elastocal {

/// Returns the samples of the markers of trial `markers_of` with the joint log of trial `log_of`.
using SampleWithLog = std::function<TrialSamples(std::size_t markers_of, std::size_t log_of)>;

/// Finds pairs of trials that have each other's joint log, and refuses both with a sentence that
/// says so. A pair is tried if the clock of one trial cannot be told, and the other trial is one
/// - whose clock cannot be told either, or
/// - whose correlation of speeds is below 0.98, or
/// - whose log covers less than half of its time.
/// The logs are exchanged if, with the other's log, each trial's clock can be told and its
/// correlation lacks less than a quarter of what it lacked to 1. A trial in use with a log of less
/// than half of its time needs only a correlation that is no worse, by a log of at least half.
///
/// If more than four clocks cannot be told, nothing is tried, because the logs then have another
/// fault in common. `sample` may throw InputError (a log without the joints of that trial), which
/// means that the logs of this pair are not exchanged.
void RefuseExchangedLogs(const SampleWithLog& sample, std::vector<TrialSamples>& samples);

}  // namespace elastocal
