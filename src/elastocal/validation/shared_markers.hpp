// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/validation/common_parameters.hpp"
#include "elastocal/validation/significance.hpp"

namespace elastocal {

/// The markers on one link that two calibrations of a robot have in common.
struct LinkMarkers {
  std::string link;
  std::vector<std::string> markers;
  bool same = false;  ///< both calibrations find them at the same positions
  /// Probability of at least this difference of their positions if none has moved, given that the
  /// markers of the other links marked `same` have not moved.
  double p = 1.0;
  /// They are not `same` only because their motion as one piece explains differences for which
  /// otherwise several joints would be accused.
  bool as_one_piece = false;
};

/// Standard deviation of the difference of a marker's coordinate between two days, if nobody
/// touched the marker: its mount yields a little, and the cameras are calibrated anew.
inline constexpr double kMarkerReturns = 1e-4;  // m

/// Links with three common markers or more, in the order of B. The positions of fewer markers do
/// not tell whether they were fixed anew.
std::vector<LinkMarkers> FindCommonMarkers(const std::vector<MarkerPlace>& a,
                                           const std::vector<MarkerPlace>& b);

/// A coordinate of a common marker: its index in the parameters of A and of B, and its nominal
/// value in B minus that in A, m.
struct MarkerCoordinate {
  int in_a = 0, in_b = 0;
  double nominal_difference = 0.0;
};

/// Coordinates of the markers of a link, three for each marker. Empty if one of them is not
/// estimated in both.
std::vector<MarkerCoordinate> CoordinatesOf(const LinkMarkers& link, const CalibrationEstimate& a,
                                            const CalibrationEstimate& b);

/// Rows of the markers on links that are marked `same`. `rows` holds all rows by link.
std::vector<int> RowsOfUnmoved(const std::vector<std::vector<int>>& rows,
                               const std::vector<LinkMarkers>& links);

/// Decides on which links no marker has moved between two calibrations, and marks them `same`.
///
/// Three markers or more that are glued anew do not return to their relative positions within the
/// tenth of a millimetre to which these are known. All markers are therefore assumed to be where
/// they were. The link whose markers contradict all others most is then given up, and so on until
/// no link is significant at the level (corrected for the number of links by Bonferroni). Any joint
/// may have moved meanwhile: the test uses only what both calibrations tell about the markers
/// whatever the robot is.
///
/// `differences` are those of the robot and the markers. `rows` holds by link the rows of its
/// markers. Throws std::invalid_argument if the covariance is not positive definite.
void FindUnmovedMarkers(const Differences& differences, const std::vector<std::vector<int>>& rows,
                        double level, std::vector<LinkMarkers>& links);

}  // namespace elastocal
