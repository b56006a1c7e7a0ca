// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/impossible_gears.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/robot/coordinates.hpp"
#include "elastocal/screening/gains_of_gears.hpp"

namespace elastocal {

std::string ScaleOfSlides(const std::vector<RecordingFault>& faults, const RobotTree& tree,
                          const std::optional<CommonScale>& scale) {
  constexpr double kAlike = 1e-3, kPlain = 2.0, kConsistent = 3.0;
  double least = 1.0, most = -1.0, sd = 0.0;
  std::string joints;
  for (const RecordingFault& fault : faults) {
    const Joint& joint = JointOfCoordinate(tree, std::max(0, fault.coordinate));
    if (fault.kind != FaultKind::kJointGain || fault.coordinate < 0 || fault.trial >= 0 ||
        joint.type != JointType::kPrismatic) {
      return "";
    }
    least = std::min(least, fault.size);
    most = std::max(most, fault.size);
    sd = std::max(sd, fault.sd);
    joints += (joints.empty() ? "" : ", ") + joint.name;
  }
  if (faults.empty() || most - least > kAlike + kConsistent * sd) return "";
  const double size = 1.0 / (1.0 + 0.5 * (least + most)) - 1.0;
  const std::string accept = fmt::format("--accept scale={:.5f} corrects it", 1.0 + size);
  if (faults.size() > 1) {
    return fmt::format(
        "the cameras' positions seem {:.4f} +- {:.4f} times the true ones: {} seem to be wrong by "
        "the same factor ({})",
        1.0 + size, sd, joints, accept);
  }
  if (!scale || scale->of_one_length || std::abs(scale->size - size) > kConsistent * scale->sd ||
      std::abs(scale->size) < kPlain * scale->sd) {
    return "";
  }
  return fmt::format(
      "the cameras' positions seem {:.4f} +- {:.4f} times the true ones, or those of {} {:.4f} "
      "times; the other lengths of the robot say {:.4f} +- {:.4f} of the cameras. Measure a known "
      "length first (if the cameras are wrong, {}; else --accept gain:{}={:.5f})",
      1.0 + size, sd, joints, 1.0 + most, 1.0 + scale->size, scale->sd, accept, joints, 1.0 + most);
}

std::vector<RecordingFault> FindImpossibleGears(const CalibrationResult& result) {
  // A gain of a slide may be a fault of the cameras from less on, but the lead of its screw is
  // typically off by 0.3 %, as the ratio of a gear is.
  const double largest = LeastSize(FaultKind::kJointGain, false);
  constexpr double kCertain = 5.0;  // standard deviations beyond the largest error
  std::vector<RecordingFault> faults = GainsOfGears(result);
  std::erase_if(faults, [&](const RecordingFault& fault) {
    const double error = fault.size / (1.0 + fault.size);  // of the gear, with the other sign
    return std::abs(error) < largest + kCertain * fault.sd;
  });
  return faults;
}

}  // namespace elastocal
