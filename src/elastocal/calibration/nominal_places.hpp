// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// How well the project has the places of markers, as far as a recording tells it.
struct NominalPlaces {
  /// Standard deviation of a coordinate of a marker whose errors are independent that displaces and
  /// turns clusters on their links as much as they are, m.
  double sd = 0.0;
  double directions = 0.0;  ///< in which the recording tells how clusters are displaced
  double prior_sd = 0.0;    ///< what the estimate was told of them beforehand (median), m

  /// Whether enough is told to say so.
  bool told() const;
  /// Whether the estimate was told far less than they are known to, which would help.
  bool worth_telling() const;
};

/// Not in the paper. A recording tells of a cluster how it lies against the joints beside its link,
/// but for some directions: along and about the last joint of a limb, and the frame of the root
/// link. What clusters are displaced in all other directions, beyond what the estimate is uncertain
/// by, tells how well `positions_mm` of the project were measured or drawn; the likeliest sd of
/// displacements and turns of the clusters of three markers and more, nothing of their shapes,
/// which a plate has exactly wherever it is fixed. Whoever measured all clusters alike then knows
/// the other directions as well (`prior: {marker_mm: ...}`). An error that all clusters have along
/// one axis of a last joint is not seen.
NominalPlaces AssessNominalPlaces(const CalibrationResult& result);

}  // namespace elastocal
