// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// Two markers on a bar (a wand, a rail, a column) whose distance is known better than cameras
/// measure. They are not on the robot.
struct ReferenceLength {
  std::array<std::string, 2> markers;  ///< labels in the cameras' files
  double length = 0.0;                 ///< m
  double sd = 0.0;                     ///< of the length, m
};

/// Scale error of the cameras: by how much they measure lengths too long.
struct MeasuredScale {
  double size = 0.0;  ///< measured over true, less 1
  double sd = 0.0;
};

/// The scale of a trial by its reference lengths: medians of the distances over the frames that
/// show both markers, weighed by their standard deviations. Frames count as a tenth of their
/// number, for neighbours share their errors; lengths that contradict each other make the standard
/// deviation wider. A label may stand behind the name of a subject ("wand:REF_1"). Nothing if no
/// length is seen in ten frames.
std::optional<MeasuredScale> MeasureScale(const std::vector<ReferenceLength>& references,
                                          const MarkerTrajectories& trajectories);

/// Whether a label of a file is that of a reference marker.
bool IsReferenceMarker(const std::vector<ReferenceLength>& references, const std::string& label);

/// Whether the scale error is larger than that of good cameras: by more than 0.05 % and by more
/// than 4.5 standard deviations.
bool IsWrong(const MeasuredScale& scale);

/// "1.00502 +- 0.00012"
std::string Describe(const MeasuredScale& scale);

}  // namespace elastocal
