// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// Positions of markers as the cameras measured them and as the robot's log predicts them, at the
/// same moments and in one frame.
struct MarkerMotion {
  /// How errors other than the lag displace the predicted positions of one marker, to first order:
  /// derivatives of its coordinates (x, y, z of the first moment, then of the next) by those
  /// unknowns that act on it.
  struct Shapes {
    std::vector<int> unknowns;    ///< indices into `prior_sd`, one for each column
    Eigen::MatrixXd derivatives;  ///< 3 moments x unknowns
  };

  Eigen::VectorXd time_s;               ///< camera time, rising
  Eigen::MatrixXd measured, predicted;  ///< moments x 3 markers, m; measured: NaN where unknown
  Eigen::MatrixXd velocity;             ///< of `predicted`, moments x 3 markers, m/s
  std::vector<Shapes> shapes;           ///< one for each marker
  Eigen::VectorXd prior_sd;             ///< prior standard deviation of each unknown
};

/// What is to be added to the lag with which a MarkerMotion was made, as a line over camera time.
struct LagChange {
  double middle_s = 0.0;  ///< camera time at which level and slope are hardly correlated
  double level_s = 0.0;   ///< change at that time
  double slope = 0.0;     ///< change in one second, s
  double level_sd_s = 0.0;
  double slope_sd = 0.0;
  double left_m = 0.0;  ///< root mean square residual of a marker's coordinate

  double At(double time_s) const { return level_s + slope * (time_s - middle_s); }
  double Sd(double time_s) const;
};

/// Estimates the change of the lag by least squares over all markers, together with the unknowns of
/// the shapes. Each marker is weighted by the inverse of its own mean squared residual. Residuals
/// are correlated between markers and between moments near each other; the standard deviations
/// therefore follow from the scatter of the score over blocks of `block_s` (sandwich estimate).
/// With `with_slope`, the change may grow linearly over time. Markers that are seen in fewer than
/// 20 moments are left out, and so are those of whose motion the model explains less than half.
///
/// Returns nothing if fewer than 12 blocks contribute, or if no marker is left.
std::optional<LagChange> FindLagChange(const MarkerMotion& motion, bool with_slope, double block_s);

}  // namespace elastocal
