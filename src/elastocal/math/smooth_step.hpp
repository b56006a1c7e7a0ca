// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace elastocal {

/// Quintic from 0 to 1 over s = 0 to 1, with slope and curvature zero at both ends; constant
/// beyond.
inline double SmoothStep(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * s * (10.0 + s * (6.0 * s - 15.0));
}

}  // namespace elastocal
