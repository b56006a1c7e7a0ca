// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/exchanged_logs.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

constexpr double kPoorPeak = 0.98;       // below this correlation, a log may be of another trial
constexpr double kLittleOfTrial = 0.5;   // share of a trial's duration
constexpr double kLackWithRight = 0.25;  // share that the right log leaves of 1 - correlation
constexpr int kMostUntold =
    4;  // trials: more have another cause in common, and each attempt reads files

bool ClockIsUntold(const TrialSummary& summary) {
  return !summary.refused.empty() && summary.clock.state != ClockState::kReliable;
}

/// A short log fits some part of a long trial by chance.
bool CoversLittle(const TrialSummary& summary) {
  return (summary.log_end_s - summary.log_begin_s) * summary.rate_hz <
         kLittleOfTrial * summary.frame_count;
}

/// Whether another trial's log fits the markers far better than their own log, or as well and
/// covers far more of the trial.
bool FitsBetter(const SampleWithLog& sample, const TrialSummary& own, std::size_t markers_of,
                std::size_t log_of) {
  try {
    const TrialSamples other = sample(markers_of, log_of);
    if (!other.summary.refused.empty()) return false;
    const bool longer = own.refused.empty() && CoversLittle(own) && !CoversLittle(other.summary) &&
                        other.summary.clock.peak >= own.clock.peak;
    return longer || 1.0 - other.summary.clock.peak < kLackWithRight * (1.0 - own.clock.peak);
  } catch (const InputError&) {
    return false;
  }
}

void RefuseAs(const std::string& reason, TrialSamples& samples) {
  TrialSamples refused;
  refused.summary = std::move(samples.summary);
  refused.summary.refused = reason;
  refused.summary.rests.reset();
  refused.summary.signal.chosen.clear();
  refused.summary.postures_seen.clear();
  refused.summary.postures = refused.summary.samples = 0;
  samples = std::move(refused);
}

}  // namespace

void RefuseExchangedLogs(const SampleWithLog& sample, std::vector<TrialSamples>& samples) {
  const auto untold = std::count_if(samples.begin(), samples.end(), [](const TrialSamples& one) {
    return ClockIsUntold(one.summary);
  });
  if (untold > kMostUntold) return;
  std::vector<char> explained(samples.size(), 0);
  for (std::size_t a = 0; a < samples.size(); ++a) {
    if (!ClockIsUntold(samples[a].summary)) continue;
    for (std::size_t b = 0; b < samples.size() && explained[a] == 0; ++b) {
      const TrialSummary& other = samples[b].summary;
      const bool poor =
          ClockIsUntold(other) ||
          (other.refused.empty() && (other.clock.peak < kPoorPeak || CoversLittle(other)));
      if (a == b || explained[b] != 0 || !poor || (ClockIsUntold(other) && b < a)) continue;
      if (!FitsBetter(sample, samples[a].summary, a, b) || !FitsBetter(sample, other, b, a)) {
        continue;
      }
      const std::string reason =
          "the joint logs of trials " + samples[std::min(a, b)].summary.trial.name + " and " +
          samples[std::max(a, b)].summary.trial.name +
          " seem to be exchanged: the markers of each move as the log of the other says";
      RefuseAs(reason, samples[a]);
      RefuseAs(reason, samples[b]);
      explained[a] = explained[b] = 1;
    }
  }
}

}  // namespace elastocal
