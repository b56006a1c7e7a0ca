// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/observation/observation_fit.hpp"

namespace elastocal {

/// A touch that was none, because the plate was above its table.
struct TouchInTheAir {
  int observation = 0;
  double height = 0.0;  ///< above the table that the other touches show, m
};

/// Finds touches in the air, in the order of the observations; empty where all are plausible.
///
/// Single ones are outliers of any estimate. Many of them, up to two thirds, raise the table and
/// the noise until nothing contradicts anything. But a plate can only be above its table. The
/// search therefore starts with the touches of each plate whose heights are closest together,
/// estimates the robot from them, predicts all others, and adds those that the prediction explains.
/// The touches that stay out are in the air if the noise of heights without them is at most half,
/// and half of them are at least five times this noise above the table. Touches that are off for
/// another reason lie on both sides.
std::vector<TouchInTheAir> FindTouchesInTheAir(const ObservedRobot& model,
                                               const Observations& observations);

/// The observations without these touches; postures without any other observation are left out.
Observations WithoutTouches(const Observations& observations,
                            const std::vector<TouchInTheAir>& touches);

}  // namespace elastocal
