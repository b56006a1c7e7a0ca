// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ctime>
#include <vector>

#include <Eigen/Core>
#include <benchmark/benchmark.h>

#include "elastocal/math/statistics.hpp"

namespace elastocal {

/// Processor seconds of this thread. On a shared machine, wall-clock time includes the work of
/// others, the more the longer the work takes.
inline double ProcessorSeconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Processor seconds that `work` takes on this thread.
template <typename Work>
double TimeOnce(const Work& work) {
  const double start = ProcessorSeconds();
  work();
  return ProcessorSeconds() - start;
}

inline double MedianOf(const std::vector<double>& seconds) {
  return Median(Eigen::VectorXd::Map(seconds.data(), static_cast<Eigen::Index>(seconds.size())));
}

/// Runs two implementations of the same work in turns, so that other work on the machine slows
/// both. Reports the median seconds of each, divided by `count` (of postures in one run), and how
/// many times faster `ours` is. The columns Time and CPU are the sums of both.
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
