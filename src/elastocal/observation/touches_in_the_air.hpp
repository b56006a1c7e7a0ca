// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/observation/observation_fit.hpp"

namespace elastocal {

/// A touch that was none: the plate stood above its table.
struct TouchInTheAir {
  int observation = 0;
  double height = 0.0;  ///< over the table that the others show, m
};

/// Touches in the air, in the order of the observations; none where all are plausible.
///
/// Single ones are outliers of any estimate. Many, up to two thirds, lift the table and the noise
/// until nothing contradicts anything. But they can only be above the table: from the lowest
/// touches of each plate on, the robot is estimated from those that lie on one plane, all others
/// are predicted by it, and those that the prediction explains come in. Those that stay out are in
/// the air if without them the noise of heights is less than half, and half of them are five times
/// this noise above the table. Touches that are that much off for another reason lie on both sides.
std::vector<TouchInTheAir> FindTouchesInTheAir(const ObservedRobot& model,
                                               const Observations& observations);

/// The observations without these touches; postures that show nothing else are left out.
Observations WithoutTouches(const Observations& observations,
                            const std::vector<TouchInTheAir>& touches);

}  // namespace elastocal
