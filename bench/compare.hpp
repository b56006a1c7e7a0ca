#pragma once

#include <chrono>
#include <vector>

#include <benchmark/benchmark.h>
#include <Eigen/Core>

#include "elastocal/math/statistics.hpp"

namespace elastocal {

/// Seconds that `work` takes.
template <typename Work>
double TimeOnce(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
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
  state.counters["ours"] = MedianOf(our_seconds) / count;
  state.counters["theirs"] = MedianOf(their_seconds) / count;
  state.counters["times_faster"] = MedianOf(their_seconds) / MedianOf(our_seconds);
}

}  // namespace elastocal
