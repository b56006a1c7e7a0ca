// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/observation/observed_posture.hpp"

namespace elastocal {

constexpr int kFewestRowsTried = 8;  ///< postures: of few, anything is explained

/// Places the nominal robot among what it sees.
ObservedValues PlacedAmong(const ObservedRobot& model, const Observations& some);

/// Squares over the largest errors that calibrated robots have (LargestError), summed over the
/// kinds of rows.
double SquaresOf(const ObservedRobot& model, const Observations& some,
                 const ObservedValues& values);

/// How badly the nominal robot explains what it sees.
struct ObservedMisfit {
  double squares = 0.0;  ///< what is left (SquaresOf)
  /// By how much tags, cameras and inertial units are turned from where the project has them:
  /// squares over 45 degrees, or three standard deviations where that is more. A tag whose corners
  /// run the other way round is seen as well as others, from behind.
  double turned = 0.0;
};

/// The misfit in some of the postures, evenly spread, once the nominal robot is placed; infinite
/// where it cannot be placed, and with fewer rows than kFewestRowsTried.
ObservedMisfit MisfitOfNominal(const ObservedRobot& model, const Observations& all);

}  // namespace elastocal
