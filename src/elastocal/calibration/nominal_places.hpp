// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// How well the project knows the positions of its markers, as far as a recording tells.
struct NominalPlaces {
  /// Standard deviation of a marker coordinate, m: that of independent errors which would displace
  /// and turn the clusters on their links as much as was found.
  double sd = 0.0;
  /// Number of directions in which the recording tells the displacement of clusters.
  double directions = 0.0;
  /// Median standard deviation of a marker coordinate in the prior of the estimate, m.
  double prior_sd = 0.0;

  /// Whether `sd` rests on enough directions (20).
  bool told() const;
  /// Whether a narrower prior on markers would help: `sd` is told, below 10 mm, and less than a
  /// third of `prior_sd`.
  bool worth_telling() const;
};

/// Estimates how well the project knows its marker positions. Not in the paper. A recording tells
/// how a cluster lies relative to the joints beside its link, except in some directions: along and
/// about the last joint of a limb, and those of the root link's frame. The displacements of
/// clusters in all other directions, beyond the uncertainty of the estimate, tell how well
/// `positions_mm` of the project were measured or drawn. `sd` is the most likely value for
/// displacements and rotations of the clusters of three markers and more. Their shapes are not
/// used, because a plate has its shape wherever it is fixed. If all clusters were measured alike,
/// `sd` also holds for the directions that the recording does not tell (`prior: {marker_mm: ...}`).
/// An error that all clusters have along the axis of their last joint is not seen.
NominalPlaces AssessNominalPlaces(const CalibrationResult& result);

}  // namespace elastocal
