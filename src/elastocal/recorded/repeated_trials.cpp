// SPDX-License-Identifier: Apache-2.0
#include "elastocal/recorded/repeated_trials.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <utility>

#include "elastocal/math/numbers.hpp"
#include "elastocal/readers/byte_source.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

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

bool HaveSameBytes(const fs::path& a, const fs::path& b) {
  std::error_code of_a, of_b;
  const auto size_a = fs::file_size(a, of_a), size_b = fs::file_size(b, of_b);
  if (of_a || of_b || size_a == 0 || size_a != size_b) return false;
  std::ifstream first(a, std::ios::binary), second(b, std::ios::binary);
  std::array<char, 1 << 16> x{}, y{};
  std::uintmax_t compared = 0;
  while (compared < size_a) {
    first.read(x.data(), x.size());
    second.read(y.data(), y.size());
    if (first.gcount() == 0 || first.gcount() != second.gcount()) return false;
    if (!std::equal(x.begin(), x.begin() + first.gcount(), y.begin())) return false;
    compared += static_cast<std::uintmax_t>(first.gcount());
  }
  return true;
}

/// Whether two recordings (a file, or the folder of a bag) hold the same bytes.
bool HaveSameContents(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (!fs::exists(a, error) || !fs::exists(b, error)) return false;
  const std::vector<fs::path> of_a = FilesOfRecording(a), of_b = FilesOfRecording(b);
  return !of_a.empty() && std::ranges::equal(of_a, of_b, HaveSameBytes);
}

/// Whether the cameras recorded at the same time of one log.
bool AreAtOneTime(const TrialSummary& a, const TrialSummary& b) {
  const auto times = [](const TrialSummary& trial) -> std::pair<double, double> {
    const double duration = trial.rate_hz > 0.0 ? trial.frame_count / trial.rate_hz : 0.0;
    return {-trial.log_begin_s, duration - trial.log_begin_s};  // since the log began
  };
  const auto [begin_a, end_a] = times(a);
  const auto [begin_b, end_b] = times(b);
  return std::max(begin_a, begin_b) < std::min(end_a, end_b);
}

/// Whether two trials have the files of one motion, whatever samples were taken of them. One log
/// may hold several motions.
bool HaveSameFiles(const Measurements& measured, const Trial& a, const Trial& b) {
  const auto summary = [&](const Trial& of) {
    return std::ranges::find(measured.trials, of.name,
                             [](const TrialSummary& one) { return one.trial.name; });
  };
  const auto of_a = summary(a), of_b = summary(b);
  if (of_a == measured.trials.end() || of_b == measured.trials.end()) return false;
  return HaveSameContents(of_a->markers_source, of_b->markers_source) ||
         (AreAtOneTime(*of_a, *of_b) && HaveSameContents(of_a->joints_source, of_b->joints_source));
}

/// In words, why the second trial is no other one than the first; empty if it is.
std::string Repetition(const Measurements& measured, const Recording& of_a, const TrialRows& rows_a,
                       const Trial& a, const Recording& of_b, const TrialRows& rows_b,
                       const Trial& b) {
  if (rows_a.second == 0 || rows_b.second == 0) return "";
  if (AreEqual(of_a, rows_a, of_b, rows_b)) {
    return "trial " + b.name + " is the same recording as trial " + a.name + ", number for number";
  }
  if (!HaveSameFiles(measured, a, b)) return "";
  return "trial " + b.name + " is the same recording as trial " + a.name +
         ", sampled otherwise (a file of theirs has the same contents)";
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
      const std::string same = Repetition(measured, estimated, of_estimated[a], estimated.trials[a],
                                          estimated, of_estimated[b], estimated.trials[b]);
      if (!same.empty()) repeated.estimated_twice.push_back(same + ": it counts twice");
    }
    for (std::size_t b = 0; b < of_judged.size(); ++b) {
      const std::string same = Repetition(measured, estimated, of_estimated[a], estimated.trials[a],
                                          judged, of_judged[b], judged.trials[b]);
      if (same.empty()) continue;
      repeated.judged_by_estimated.push_back(
          same + ": it cannot judge the calibration (a file that was copied?)");
    }
  }
  return repeated;
}

}  // namespace elastocal
