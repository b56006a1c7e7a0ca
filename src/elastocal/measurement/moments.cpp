// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/moments.hpp"

#include <algorithm>

namespace elastocal {
namespace {

constexpr double kNextMoment_s = 0.5;

bool Follows(const Recording& recording, int posture) {
  if (recording.time_s.size() == 0) return false;
  const double step = recording.time_s[posture] - recording.time_s[posture - 1];
  if (recording.trials.empty()) return step > 0.0 && step < kNextMoment_s;
  const int trial = recording.trial[posture];
  return trial == recording.trial[posture - 1] && recording.trials[trial].of_motion() && step > 0.0;
}

}  // namespace

std::vector<int> MotionOfPostures(const Recording& recording) {
  std::vector<int> motion(recording.posture_count(), -1);
  int last = -1;
  for (int i = 1; i < recording.posture_count(); ++i) {
    if (!Follows(recording, i)) continue;
    if (motion[i - 1] < 0) motion[i - 1] = ++last;
    motion[i] = last;
  }
  return motion;
}

bool HasMotion(const Recording& recording) {
  const std::vector<int> motion = MotionOfPostures(recording);
  return std::any_of(motion.begin(), motion.end(), [](int of) { return of >= 0; });
}

std::vector<int> PosturesOfTrial(const Recording& recording, int trial) {
  std::vector<int> postures;
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (recording.trials.empty() || recording.trial[i] == trial) postures.push_back(i);
  }
  return postures;
}

}  // namespace elastocal
