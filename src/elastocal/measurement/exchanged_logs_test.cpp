// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/exchanged_logs.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

TrialSamples WithClock(const std::string& name, ClockState state, double peak) {
  TrialSamples samples;
  samples.summary.trial.name = name;
  samples.summary.clock.state = state;
  samples.summary.clock.peak = peak;
  if (state != ClockState::kReliable) {
    samples.summary.refused = "no clock";
  } else {
    samples.frames = {8};
    samples.summary.postures = 1;
  }
  return samples;
}

/// Reads trials whose own logs are those of the trials `own`. `peak` is the correlation with the
/// own log.
SampleWithLog Sampler(const std::vector<std::size_t>& own, double peak) {
  return [=](std::size_t markers_of, std::size_t log_of) {
    if (log_of == 3) throw InputError("a log without its joints");
    const bool fits = own[markers_of] == log_of;
    return WithClock("", fits ? ClockState::kReliable : ClockState::kWeak, fits ? peak : 0.4);
  };
}

// The third trial takes no part. The log of the last one cannot be read for any other trial.
TEST(ExchangedLogs, TwoTrialsWithEachOthersLogSaySo) {
  const auto read = [] {
    return std::vector<TrialSamples>{
        WithClock("a", ClockState::kWeak, 0.3), WithClock("b", ClockState::kReliable, 0.7),
        WithClock("c", ClockState::kReliable, 0.999), WithClock("d", ClockState::kWeak, 0.2)};
  };
  std::vector<TrialSamples> samples = read();
  RefuseExchangedLogs(Sampler({1, 0, 2, 3}, 0.99), samples);
  for (const int k : {0, 1}) {
    const TrialSamples& one = samples[static_cast<std::size_t>(k)];
    EXPECT_EQ(one.summary.refused.rfind("the joint logs of trials a and b seem to be exchanged", 0),
              0u)
        << one.summary.refused;
    EXPECT_TRUE(one.frames.empty());
    EXPECT_EQ(one.summary.postures, 0);
  }
  EXPECT_TRUE(samples[2].summary.refused.empty());
  EXPECT_EQ(samples[3].summary.refused, "no clock");

  // One of the two trials fits no other log better than its own, so nothing is exchanged.
  samples = read();
  RefuseExchangedLogs(Sampler({1, 1, 2, 3}, 0.99), samples);
  EXPECT_EQ(samples[0].summary.refused, "no clock");
  EXPECT_TRUE(samples[1].summary.refused.empty());

  // The other log fits hardly better than the trial's own.
  samples = read();
  RefuseExchangedLogs(Sampler({1, 0, 2, 3}, 0.8), samples);
  EXPECT_EQ(samples[0].summary.refused, "no clock");
}

// Trials of random postures can fit the log of a repetition.
TEST(ExchangedLogs, AShortLogFitsALongTrialByChance) {
  for (const double covered_s : {4.0, 8.0}) {
    std::vector<TrialSamples> samples{WithClock("a", ClockState::kWeak, 0.3),
                                      WithClock("b", ClockState::kReliable, 0.985)};
    samples[1].summary.rate_hz = 100.0;
    samples[1].summary.frame_count = 1000;
    samples[1].summary.log_begin_s = 5.0 - 0.5 * covered_s;
    samples[1].summary.log_end_s = 5.0 + 0.5 * covered_s;
    RefuseExchangedLogs(Sampler({1, 0}, 0.99), samples);
    EXPECT_EQ(samples[1].summary.refused.empty(), covered_s == 8.0) << samples[1].summary.refused;
  }
}

// Each try reads files and estimates a clock.
TEST(ExchangedLogs, AreNotLookedForWhereMostClocksCannotBeTold) {
  std::vector<TrialSamples> samples;
  for (int k = 0; k < 5; ++k) samples.push_back(WithClock("t", ClockState::kWeak, 0.3));
  int tries = 0;
  const SampleWithLog count = [&](std::size_t, std::size_t) {
    ++tries;
    return WithClock("", ClockState::kWeak, 0.3);
  };
  RefuseExchangedLogs(count, samples);
  EXPECT_EQ(tries, 0);
  samples.pop_back();
  RefuseExchangedLogs(count, samples);
  EXPECT_EQ(tries, 6);  // of each pair, only the first direction, which fails
}

}  // namespace
}  // namespace elastocal
