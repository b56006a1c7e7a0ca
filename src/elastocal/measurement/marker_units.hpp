// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// A wrong unit of length: one marker's coordinates are in another unit than those of the others,
/// or all coordinates are in another unit than the one in which they were read.
struct OtherUnit {
  std::string marker;   ///< name of the marker; empty: all markers
  double factor = 1.0;  ///< by which the coordinates are to be multiplied
  /// For one marker: median error of its distances to others of its link, against the project, m.
  /// For all markers: measured distance of the first pair of markers on one link, m.
  double before = 0.0;
  /// For one marker: the same error after multiplication. For all markers: the distance of the
  /// first pair in the project, m.
  double after = 0.0;
};

/// Finds a wrong unit in `positions` (rows x 3 markers, m; NaN where not seen) of markers with
/// these names. `robot` has the nominal markers. The factors that are tried are 10, 100, 1000, 25.4
/// and their inverses.
/// - All markers are in another unit if, with one factor, at least four in five of the distances
///   between markers of one link are within 30 % of the nominal ones. At least three distances of
///   30 mm or more are needed.
/// - One marker is in another unit if the median error of its distances to the others of its link
///   (at least two) is above 100 mm, and with one factor is below 30 mm and below a tenth of that.
std::optional<OtherUnit> FindOtherUnit(const Eigen::MatrixXd& positions,
                                       const std::vector<std::string>& names,
                                       const std::vector<Marker>& robot);

/// "marker HAND_1: its coordinates seem 1000 times too small ..."
std::string Describe(const OtherUnit& found);

}  // namespace elastocal
