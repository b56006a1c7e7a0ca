// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/frame_shifts.hpp"

#include <algorithm>
#include <cstdio>

#include "elastocal/measurement/describe_posture.hpp"
#include "elastocal/robot/coordinates.hpp"

namespace elastocal {

void PreferSlides(const RobotTree& tree, std::vector<RecordingFault>& faults) {
  constexpr double kAsMuch = 0.95;
  const std::vector<RecordingFault> all = faults;
  const auto slides = [&](const RecordingFault& one) {
    return one.kind == FaultKind::kJointOffset && one.linkage < 0 &&
           JointOfCoordinate(tree, one.coordinate).type == JointType::kPrismatic;
  };
  const auto shifts = [](const RecordingFault& one) { return one.kind == FaultKind::kFrameShift; };
  const auto explains_as_much = [](const RecordingFault& one, const RecordingFault& other) {
    return one.posture == other.posture && one.end == other.end &&
           one.share >= kAsMuch * other.share;
  };
  for (RecordingFault& joint : faults) {
    const auto shift = std::ranges::find_if(all, [&](const RecordingFault& one) {
      return slides(joint) && shifts(one) && explains_as_much(one, joint);
    });
    if (shift != all.end()) joint.axis = shift->axis;
  }
  std::erase_if(faults, [&](const RecordingFault& shift) {
    return shifts(shift) && std::ranges::any_of(all, [&](const RecordingFault& one) {
             return slides(one) && explains_as_much(one, shift);
           });
  });
}

std::string DescribeShifts(const std::vector<RecordingFault>& shifts, const Recording& recording) {
  std::string text = "the frame of the markers lies";
  for (const RecordingFault& shift : shifts) {
    const bool first = &shift == &shifts.front();
    char along[80];
    std::snprintf(along, sizeof along, "%s %.2f +- %.2f mm%s along %c", first ? "" : " and",
                  1e3 * shift.size, 1e3 * shift.sd, first ? " elsewhere" : "", "xyz"[shift.axis]);
    text += along;
  }
  const RecordingFault& of = shifts.front();
  text += " from " + DescribePosture(recording, of.posture);
  text += of.end > 0 ? " to " + DescribePosture(recording, of.end - 1) : " on";
  return text + " (the tracker or the base was pushed?)";
}

}  // namespace elastocal
