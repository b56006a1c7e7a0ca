// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/observation/observed_posture.hpp"

namespace elastocal {

constexpr int kFewestRowsTried = 8;  ///< postures: with fewer, anything can be explained

/// Places the nominal robot by some of the observations.
ObservedValues PlacedAmong(const ObservedRobot& model, const Observations& some);

/// Sum of squared residuals over the largest errors of calibrated robots (LargestError), by kind of
/// row.
double SquaresOf(const ObservedRobot& model, const Observations& some,
                 const ObservedValues& values);

/// Misfit of the nominal robot.
struct ObservedMisfit {
  double squares = 0.0;  ///< squares that are left (SquaresOf)
  /// Rotation of tags, cameras and inertial units from their orientation in the project: squares
  /// over 45 degrees, or over three standard deviations if those are larger. A tag whose corners
  /// run the other way round is also seen well, from behind.
  double turned = 0.0;
};

/// Misfit in some evenly spread postures, after the nominal robot is placed. Infinite where it
/// cannot be placed, and with fewer rows than kFewestRowsTried.
ObservedMisfit MisfitOfNominal(const ObservedRobot& model, const Observations& all);

}  // namespace elastocal
