// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "elastocal/measurement/trial_samples.hpp"

namespace elastocal {

/// The samples of the markers of one trial with the joint log of another one.
using SampleWithLog = std::function<TrialSamples(std::size_t markers_of, std::size_t log_of)>;

/// Trials that have each other's joint log. Tried are each trial whose clock cannot be told, and
/// each other one with a correlation of speeds below 0.98 or a log of less than half of its time:
/// two of them have if both clocks can be told once the logs are exchanged, with a quarter, at
/// most, of what the correlations lacked to one; where the own log is the short one, no worse a
/// correlation is enough. Both are refused then, whatever could be made of
/// one, and say so. Where more than four clocks cannot be told, nothing is tried: the logs have
/// another fault in common. `sample` may throw InputError: a log without the joints of that trial.
void RefuseExchangedLogs(const SampleWithLog& sample, std::vector<TrialSamples>& samples);

}  // namespace elastocal
