// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/thinned_motions.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "elastocal/math/numbers.hpp"

namespace elastocal {

namespace {

/// Every how many of the moments one is kept, if at most `most` are to be left.
int StepOver(int moments, int most) { return std::max(1, (moments + most - 1) / most); }

bool Differ(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, int row) {
  for (Eigen::Index j = 0; j < a.cols(); ++j) {
    const double x = a(row, j), y = b(row, j);
    if (x != y && !(std::isnan(x) && std::isnan(y))) return true;
  }
  return false;
}

}  // namespace

std::vector<int> ThinnedMotions(const Recording& recording, int most) {
  return ThinnedMotions(recording, most, std::vector<int>(recording.trial.size(), 0), 0);
}

std::vector<int> ThinnedMotions(const Recording& recording, int most, const std::vector<int>& group,
                                int least) {
  const auto moves = [&](int i) {
    return recording.trials[Size(recording.trial[Size(i)])].of_motion();
  };
  std::map<int, int> moments;  // by group
  int all = 0;
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (!moves(i)) continue;
    ++moments[group[Size(i)]];
    ++all;
  }
  std::map<int, int> step;
  for (const auto& [of, count] : moments) {
    step[of] = std::clamp(count / std::max(1, least), 1, StepOver(all, most));
  }
  std::vector<int> kept;
  std::map<int, int> moment;
  for (int i = 0; i < recording.posture_count(); ++i) {
    const int of = group[Size(i)];
    if (!moves(i) || moment[of]++ % step[of] == 0) kept.push_back(i);
  }
  return kept;
}

Recording WithThinnedMotions(const Recording& recording, int most) {
  if (recording.trials.empty()) return EvenlyThinned(recording, most);
  return SelectPostures(recording, ThinnedMotions(recording, most));
}

std::vector<int> FewPostures(const Recording& recorded, const Recording& corrected, int most) {
  const int postures = recorded.posture_count();
  if (recorded.trials.empty() || corrected.posture_count() != postures) return {};
  std::vector<int> kept, changed, others;
  for (int i = 0; i < postures; ++i) {
    const bool rests = !recorded.trials[Size(recorded.trial[Size(i)])].of_motion();
    const bool differs =
        Differ(recorded.q, corrected.q, i) || Differ(recorded.markers, corrected.markers, i);
    (rests ? kept : differs ? changed : others).push_back(i);
  }
  for (const std::vector<int>& moments : {changed, others}) {
    const auto step = Size(StepOver(static_cast<int>(moments.size()), most));
    for (std::size_t i = 0; i < moments.size(); i += step) kept.push_back(moments[i]);
  }
  if (4 * kept.size() >= Size(postures)) return {};
  std::sort(kept.begin(), kept.end());
  return kept;
}

}  // namespace elastocal
