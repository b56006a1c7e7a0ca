// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/still_joints.hpp"

#include <algorithm>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/recorded_joints.hpp"

namespace elastocal {

std::string StillJoints(const ErrorModel& model, const Recording& recording) {
  constexpr double kStill = 1e-3;  // rad or m
  std::set<int> moving;
  for (const int k : model.active_joints) {
    for (const Drive& drive : DrivesOf(model.tree.joints[Size(k)])) moving.insert(drive.coordinate);
  }
  std::vector<std::string> still;
  for (const int c : moving) {
    const std::string& name = JointOfCoordinate(model.tree, c).name;
    const double range = recording.q.col(c).maxCoeff() - recording.q.col(c).minCoeff();
    if (range < kStill && IsRecorded(recording, model.tree, c)) {
      still.push_back(name);
    }
  }
  if (still.empty() || recording.posture_count() < 2) return "";
  return fmt::format(
      "{} stood still in all postures: what its motion would show is not known, and no error given "
      "here holds where it moves",
      fmt::join(still, ", "));
}

}  // namespace elastocal
