// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// One coordinate of one marker through a trial, before and after the filter, and the frames that
/// became samples. It is a figure for people (Fig. 4 of the paper).
struct SignalExcerpt {
  std::string marker;
  int axis = 0;                  ///< 0, 1, 2 for x, y, z of the cameras
  std::vector<double> raw;       ///< by frame, m; NaN where the marker was not seen
  std::vector<double> filtered;  ///< by frame, m; NaN in gaps
  std::vector<int> chosen = {};  ///< frames that became samples, ascending
};

/// The raw coordinate with the largest range; `filtered` is empty. The marker's name is empty for a
/// trial without trajectories.
SignalExcerpt TakeExcerpt(const MarkerTrajectories& raw);

/// Adds the same coordinate of the filtered trajectories, which must have the same markers.
void AddFiltered(const MarkerTrajectories& filtered, SignalExcerpt& excerpt);

}  // namespace elastocal
