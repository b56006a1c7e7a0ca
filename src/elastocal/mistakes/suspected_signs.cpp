// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/suspected_signs.hpp"

#include <numeric>
#include <set>

#include "elastocal/calibration/turned_axes.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/recorded_joints.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kMostSigns = 12;

}  // namespace

LogSuspicion SignOf(int coordinate, const Recording& recording) {
  LogSuspicion sign{.kind = LogContradiction::kSign, .coordinate = coordinate};
  sign.postures.resize(Size(recording.posture_count()));
  std::iota(sign.postures.begin(), sign.postures.end(), 0);
  return sign;
}

std::vector<LogSuspicion> AllSigns(const RobotTree& tree, const Recording& recording) {
  std::vector<LogSuspicion> signs;
  for (int c = 0; c < tree.coordinate_count(); ++c) {
    const auto positions = recording.q.col(c);
    if (positions.maxCoeff() > positions.minCoeff()) signs.push_back(SignOf(c, recording));
  }
  if (signs.size() > kMostSigns) signs.clear();
  return signs;
}

std::vector<LogSuspicion> SignsOfTurnedAxes(const CalibrationResult& result,
                                            const Recording& recording) {
  std::vector<LogSuspicion> suspicions;
  std::set<int> coordinates;
  for (const int joint : TurnedAxes(result)) {
    const std::vector<Joint>& joints = result.model.tree.joints;
    const int before = joints[Size(joint)].parent_body - 1;
    for (const int k : {joint, before}) {
      if (k < 0 || !coordinates.insert(joints[Size(k)].coordinate).second) continue;
      const int coordinate = joints[Size(k)].coordinate;
      if (IsRecorded(recording, result.model.tree, coordinate)) {
        suspicions.push_back(SignOf(coordinate, recording));
      }
    }
  }
  return suspicions;
}

}  // namespace elastocal
