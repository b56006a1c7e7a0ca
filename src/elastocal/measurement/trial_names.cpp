// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/trial_names.hpp"

namespace elastocal {

std::string TrialNames(const Recording& recording, const std::vector<int>& trials) {
  std::string names;
  for (const int trial : trials) {
    names += (names.empty() ? "" : ", ") + recording.trials[trial].name;
  }
  return names;
}

std::vector<int> TrialsWith(const Recording& recording, const std::function<bool(int)>& holds_of) {
  if (recording.trials.empty()) return {};
  std::vector<char> with(recording.trials.size(), 0);
  for (int i = 0; i < recording.posture_count(); ++i) {
    char& found = with[recording.trial[i]];
    if (found == 0 && holds_of(i)) found = 1;
  }
  std::vector<int> trials;
  for (int trial = 0; trial < static_cast<int>(with.size()); ++trial) {
    if (with[trial] != 0) trials.push_back(trial);
  }
  return trials;
}

}  // namespace elastocal
