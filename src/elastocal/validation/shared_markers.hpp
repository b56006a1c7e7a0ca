// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/validation/common_parameters.hpp"
#include "elastocal/validation/significance.hpp"

namespace elastocal {

/// The markers on a link that two calibrations of one robot both have.
struct LinkMarkers {
  std::string link;
  std::vector<std::string> markers;
  bool same = false;  ///< whether both calibrations find them in the same places
  /// Probability that their places differ as much if none has moved, given that those of the other
  /// links taken as the same have not.
  double p = 1.0;
  /// Not the same only because all of them, moved as one piece, explain what would otherwise be put
  /// down to several joints.
  bool as_one_piece = false;
};

/// Standard deviation of the difference of a coordinate of a marker that nobody touched, on another
/// day: it gives a little, and cameras are calibrated anew.
inline constexpr double kMarkerReturns = 1e-4;  // m

/// Links with three common markers or more, whose places can therefore tell whether they were fixed
/// anew. In the order of B.
std::vector<LinkMarkers> FindCommonMarkers(const std::vector<MarkerPlace>& a,
                                           const std::vector<MarkerPlace>& b);

/// A coordinate of a common marker: its row in the parameters of A and B, and by how much its
/// nominal place is elsewhere in B than in A, m.
struct MarkerCoordinate {
  int in_a = 0, in_b = 0;
  double nominal_difference = 0.0;
};

/// Those of the markers of a link, three for each. Empty if one of them is not estimated.
std::vector<MarkerCoordinate> CoordinatesOf(const LinkMarkers& link, const CalibrationEstimate& a,
                                            const CalibrationEstimate& b);

/// Rows of the markers on links where they are the same. `rows`: by link, all of them.
std::vector<int> RowsOfUnmoved(const std::vector<std::vector<int>>& rows,
                               const std::vector<LinkMarkers>& links);

/// Decides on which links no marker has moved between two calibrations.
///
/// Three markers or more that were glued anew do not come to lie within the tenth of a millimetre
/// to which their places are told against each other and markers return. So all markers are taken
/// to be where they were, and the link whose markers contradict all others most is given up, until
/// none does at the level (adjusted by Bonferroni for the number of links). Any joint may have
/// moved meanwhile: only what both calibrations tell of the markers whatever the robot is counts.
///
/// `differences`: all, of the robot and of markers. `rows`: by link, those of its markers. Throws
/// std::invalid_argument if the covariance is not positive definite.
void FindUnmovedMarkers(const Differences& differences, const std::vector<std::vector<int>>& rows,
                        double level, std::vector<LinkMarkers>& links);

}  // namespace elastocal
