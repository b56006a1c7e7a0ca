// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// A marker whose coordinates are in another unit than those of the others, or all markers whose
/// coordinates are in another unit than they were read in.
struct OtherUnit {
  std::string marker;   ///< empty: all
  double factor = 1.0;  ///< by which they are to be multiplied
  /// How far the marker is from the distances that the project gives to others of its link, m; of
  /// all, the first distance of two on one link.
  double before = 0.0;
  double after = 0.0;  ///< the same, multiplied; of all, what the project has
};

/// Looks for one in positions (rows x 3 markers, m; NaN where not seen) of markers of these names:
/// its distances to at least two others of its link are 100 mm and more off those of `robot`, by
/// the median, and 30 mm at most, a tenth of it, once its coordinates are multiplied by 10, 100,
/// 1000, 25.4 or divided by one of these. All are in another unit where one of these factors
/// explains, within 30 %, four in five of the distances of markers on one link (of which there are
/// three or more, of 30 mm or more).
std::optional<OtherUnit> FindOtherUnit(const Eigen::MatrixXd& positions,
                                       const std::vector<std::string>& names,
                                       const std::vector<Marker>& robot);

/// "marker HAND_1: its coordinates seem 1000 times too small ..."
std::string Describe(const OtherUnit& found);

}  // namespace elastocal
