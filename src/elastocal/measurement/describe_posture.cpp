// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/describe_posture.hpp"

namespace elastocal {

std::string DescribePosture(const Recording& recording, int posture) {
  std::string text = "posture " + std::to_string(posture + 1);
  if (recording.trials.empty()) return text;
  int first = 0;
  while (recording.trial[first] != recording.trial[posture]) ++first;
  return "trial " + recording.trials[recording.trial[posture]].name + ", posture " +
         std::to_string(posture - first + 1);
}

std::string DescribeObservation(const Recording& recording, int posture, int marker) {
  std::string text = DescribePosture(recording, posture);
  if (!recording.line.empty()) text += " (line " + std::to_string(recording.line[posture]) + ")";
  return text + ", marker " + recording.marker_names[marker];
}

}  // namespace elastocal
