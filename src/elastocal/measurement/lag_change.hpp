// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// Where markers are by the cameras and by the robot's log, at the same moments and in one frame.
struct MarkerMotion {
  /// What may be wrong with the predicted positions of a marker besides the lag, to first order:
  /// derivatives of its coordinates (x, y, z of the first moment, then of the next) by some of the
  /// unknowns.
  struct Shapes {
    std::vector<int> unknowns;
    Eigen::MatrixXd derivatives;  ///< 3 moments x unknowns
  };

  Eigen::VectorXd time_s;               ///< camera time, rising
  Eigen::MatrixXd measured, predicted;  ///< moments x 3 markers, m; measured: NaN where unknown
  Eigen::MatrixXd velocity;             ///< of `predicted`, moments x 3 markers, m/s
  std::vector<Shapes> shapes;           ///< by marker
  Eigen::VectorXd prior_sd;             ///< by unknown
};

/// By how much the lag is larger than the one that a MarkerMotion was made with.
struct LagChange {
  double middle_s = 0.0;  ///< camera time at which level and slope are hardly correlated
  double level_s = 0.0;   ///< change at that time
  double slope = 0.0;     ///< change in one second, s
  double level_sd_s = 0.0;
  double slope_sd = 0.0;
  double left_m = 0.0;  ///< root mean square of what is left of a marker's coordinate

  double At(double time_s) const { return level_s + slope * (time_s - middle_s); }
  double Sd(double time_s) const;
};

/// Finds the change of the lag by least squares over all markers, together with the unknowns of the
/// shapes. What the shapes do not explain is shared by markers and by moments near each other: the
/// standard deviations follow from the scatter of the score over blocks of `block_s` (sandwich),
/// and markers weigh by what is left of them. `with_slope`: whether the change grows over time.
///
/// Nothing where fewer than a dozen blocks have any motion, or no marker follows the log.
std::optional<LagChange> FindLagChange(const MarkerMotion& motion, bool with_slope, double block_s);

}  // namespace elastocal
