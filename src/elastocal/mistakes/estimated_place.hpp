// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {

/// Estimated position of a marker in the frame of its link, m.
inline Eigen::Vector3d EstimatedPlace(const CalibrationResult& result, int marker) {
  // The parameters of markers are the last ones.
  const int first = result.model.parameter_count() - 3 * result.model.marker_count();
  return result.model.markers[Size(marker)].p_link_marker +
         result.delta.segment<3>(first + 3 * marker);
}

}  // namespace elastocal
