// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/thinned_motions.hpp"

#include <algorithm>
#include <vector>

#include "elastocal/math/numbers.hpp"

namespace elastocal {

Recording WithThinnedMotions(const Recording& recording, int most) {
  if (recording.trials.empty()) return EvenlyThinned(recording, most);
  const auto moves = [&](int i) {
    return recording.trials[Size(recording.trial[Size(i)])].of_motion();
  };
  int moments = 0;
  for (int i = 0; i < recording.posture_count(); ++i) moments += moves(i) ? 1 : 0;
  const int step = std::max(1, (moments + most - 1) / most);
  std::vector<int> kept;
  int moment = 0;
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (!moves(i) || moment++ % step == 0) kept.push_back(i);
  }
  return SelectPostures(recording, kept);
}

}  // namespace elastocal
