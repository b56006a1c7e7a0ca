// SPDX-License-Identifier: Apache-2.0
#include "elastocal/recorded/repeated_trials.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

using TrialRows = std::pair<int, int>;  // first, and the one after the last

std::vector<TrialRows> RowsOfTrials(const Recording& recording) {
  std::vector<TrialRows> ranges(recording.trials.size(), {0, 0});
  if (ranges.empty()) return ranges;  // a table
  for (int i = 0; i < recording.posture_count(); ++i) {
    auto& [begin, end] = ranges[Size(recording.trial[Size(i)])];
    if (end == 0) begin = i;
    end = i + 1;
  }
  return ranges;
}

bool AreEqual(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

/// Compares the markers that both have seen; others may belong to another chain.
bool AreEqual(const Recording& a, const TrialRows& of_a, const Recording& b,
              const TrialRows& of_b) {
  const int count = of_a.second - of_a.first;
  if (count == 0 || count != of_b.second - of_b.first) return false;
  bool seen = false;
  for (int i = 0; i < count; ++i) {
    const auto p = of_a.first + i, q = of_b.first + i;
    for (Eigen::Index c = 0; c < a.q.cols(); ++c) {
      if (!AreEqual(a.q(p, c), b.q(q, c))) return false;
    }
    for (Eigen::Index c = 0; c < std::min(a.markers.cols(), b.markers.cols()); ++c) {
      const double x = a.markers(p, c), y = b.markers(q, c);
      if (std::isnan(x) || std::isnan(y)) continue;
      if (x != y) return false;
      seen = true;
    }
  }
  return seen;
}

std::string DescribeRepetition(const Trial& a, const Trial& b) {
  return "trial " + b.name + " is the same recording as trial " + a.name + ", number for number";
}

}  // namespace

RepeatedTrials FindRepeatedTrials(const Measurements& measured) {
  RepeatedTrials repeated;
  const Recording& estimated = measured.calibration;
  const Recording& judged = measured.validation;
  const std::vector<TrialRows> of_estimated = RowsOfTrials(estimated);
  const std::vector<TrialRows> of_judged = RowsOfTrials(judged);
  for (std::size_t a = 0; a < of_estimated.size(); ++a) {
    for (std::size_t b = a + 1; b < of_estimated.size(); ++b) {
      if (AreEqual(estimated, of_estimated[a], estimated, of_estimated[b])) {
        repeated.estimated_twice.push_back(
            DescribeRepetition(estimated.trials[a], estimated.trials[b]) + ": it counts twice");
      }
    }
    for (std::size_t b = 0; b < of_judged.size(); ++b) {
      if (AreEqual(estimated, of_estimated[a], judged, of_judged[b])) {
        repeated.judged_by_estimated.push_back(
            DescribeRepetition(estimated.trials[a], judged.trials[b]) +
            ": it cannot judge the calibration (a file that was copied?)");
      }
    }
  }
  return repeated;
}

}  // namespace elastocal
