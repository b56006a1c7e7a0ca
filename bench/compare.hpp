// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ctime>
#include <vector>

#include <Eigen/Core>
#include <benchmark/benchmark.h>

#include "elastocal/math/statistics.hpp"

namespace elastocal {

/// Seconds of this thread's processor: on a shared machine a clock on the wall would count the
/// others' work too, and the more of it the longer a piece of work is.
inline double ProcessorSeconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Seconds that `work` takes on this thread.
template <typename Work>
double TimeOnce(const Work& work) {
  const double start = ProcessorSeconds();
  work();
  return ProcessorSeconds() - start;
}

inline double MedianOf(const std::vector<double>& seconds) {
  return Median(Eigen::VectorXd::Map(seconds.data(), static_cast<Eigen::Index>(seconds.size())));
}

/// Runs two ways of doing the same in turns, so that whatever else the machine does at the time
/// slows both, and reports the median seconds of each, divided by `count` (of postures in one run),
/// and how many times faster `ours` is. The columns Time and CPU are of both together.
template <typename Ours, typename Theirs>
void CompareInTurns(benchmark::State& state, double count, const Ours& ours, const Theirs& theirs) {
  std::vector<double> our_seconds, their_seconds;
  for (auto _ : state) {
    our_seconds.push_back(TimeOnce(ours));
    their_seconds.push_back(TimeOnce(theirs));
  }
  state.counters["ours_s"] = MedianOf(our_seconds) / count;
  state.counters["theirs_s"] = MedianOf(their_seconds) / count;
  state.counters["times_faster"] = MedianOf(their_seconds) / MedianOf(our_seconds);
}

}  // namespace elastocal
