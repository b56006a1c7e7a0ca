// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/screening/recording_fault.hpp"

namespace elastocal {

/// Leaves out displacements of the markers' frame of which offsets of sliding joints in the same
/// postures explain at least 95 %. Along the joint they are the same, and the joint's can be
/// corrected. Where a displacement explains as much as an offset, the offset gets its `axis`.
void PreferSlides(const RobotTree& tree, std::vector<RecordingFault>& faults);

/// Whether an offset of a joint may be a displacement of the frame (PreferSlides).
inline bool MayBeShift(const RecordingFault& fault) {
  return fault.kind == FaultKind::kJointOffset && fault.axis >= 0;
}

/// Text such as "the frame of the markers lies 10.1 +- 0.8 mm elsewhere along x and 5.0 +- 0.7 mm
/// along y from posture 19 on (the tracker or the base was pushed?)", of displacements along
/// different axes in the same postures.
std::string DescribeShifts(const std::vector<RecordingFault>& shifts, const Recording& recording);

}  // namespace elastocal
