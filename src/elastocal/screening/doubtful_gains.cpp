// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/doubtful_gains.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/robot/coordinates.hpp"
#include "elastocal/robot/linkage.hpp"
#include "elastocal/robot/move_motors.hpp"
#include "elastocal/screening/gains_of_gears.hpp"
#include "elastocal/screening/measured_faults.hpp"

namespace elastocal {
std::vector<RecordingFault> FindDoubtfulGains(const CalibrationResult& result,
                                              const Recording& recording,
                                              const CalibrationOptions& options) {
  constexpr double kOneInFifty = 0.02;
  const RobotTree& tree = result.model.tree;
  std::vector<RecordingFault> gains = GainsOfGears(result);
  const auto moved_by_rods = [&](const RecordingFault& gear) {
    return IsMovedByRods(tree, tree.coordinate_joint[Size(gear.coordinate)]);
  };
  std::erase_if(gains, moved_by_rods);
  std::set<int> coordinates;
  for (const int joint : result.model.active_joints) {
    if (!IsMovedByRods(tree, joint)) coordinates.insert(tree.joints[Size(joint)].coordinate);
  }
  for (const RecordingFault& gear : gains) coordinates.erase(gear.coordinate);
  std::vector<RecordingFault> tried;
  for (const int coordinate : coordinates) tried.push_back({.coordinate = coordinate});
  for (const RecordingFault& one : MeasureFaults(tried, result, recording, options)) {
    gains.push_back(one);
  }
  const auto joints = static_cast<double>(gains.size());
  const double freedom = std::max(1, recording.posture_count() - 1);
  std::erase_if(gains, [&](const RecordingFault& gain) {
    const bool slides = JointOfCoordinate(tree, gain.coordinate).type == JointType::kPrismatic;
    const double size = std::abs(gain.size);
    return !(gain.sd > 0.0) || !(size >= LeastSize(FaultKind::kJointGain, slides)) ||
           size > LargestSize(FaultKind::kJointGain, slides) ||
           joints * StudentTwoSidedTail(size / gain.sd, freedom) > kOneInFifty;
  });
  return gains;
}

std::string DescribeDoubtfulGain(const RecordingFault& gain, const RobotTree& tree) {
  const Joint& joint = JointOfCoordinate(tree, gain.coordinate);
  const bool slides = joint.type == JointType::kPrismatic;
  char text[320];
  std::snprintf(text, sizeof text,
                ": its positions may be %.4f +- %.4f times the true ones, which is not certain "
                "enough to object to; if its log or its %s has such a factor (move the joint by a "
                "known %s and compare), --accept gain:%s=%.5f corrects it",
                1.0 + gain.size, gain.sd, slides ? "lead" : "gear", slides ? "length" : "angle",
                joint.name.c_str(), 1.0 + gain.size);
  return joint.name + text;
}

}  // namespace elastocal
