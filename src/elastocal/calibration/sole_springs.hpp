// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/measurement/foot_rests.hpp"

namespace elastocal {

// Compliance of soles. Not in the paper. Eq. 6 describes the compliance between the markers of a
// standing foot and the waist. Compliance below these markers (a sole of rubber, a force sensor, a
// soft floor) shows only where one foot stays in place while its load changes.

inline constexpr double kSoftestSole = 1e-4;  ///< m/N: under a person it would sink by 80 mm

/// Sinking of a foot's markers under the load on its sole.
struct SoleSpring {
  std::string leg;          ///< name of the model's leg
  int changes = 0;          ///< number of trials in which the foot stood as in an earlier one
  double compliance = 0.0;  ///< along gravity, m/N
  double sd = std::numeric_limits<double>::infinity();  ///< m/N; infinite: no such changes
  double interval_factor = 1.96;  ///< half width of a 95 % interval in standard deviations

  /// Whether the compliance exceeds zero at 95 %, so that it may be applied.
  bool told() const { return compliance > interval_factor * sd; }
  /// Upper end of the 95 % interval, m/N.
  double most() const;
};

/// Estimates the compliance of each sole; one entry a leg of the model. `rests` are those of all
/// trials, whatever they were recorded for; rests of the same folder and foot follow each other.
/// `gravity` is in the frame of their markers, m/s^2.
///
/// A foot stays from one trial of a folder to the next if it supports the robot in both and its
/// markers, as one body, are within 0.3 mm and 0.3 degrees of where they were (5 mm in height). The
/// height of its link's origin is then a constant minus compliance times load (least squares). The
/// load is the foot's share of the weight according to the robot description.
///
/// The standard deviation follows from the scatter about these lines and the displacements of all
/// feet along the floor, where no load moves them; drifting cameras and knocked clusters make it
/// large. 5 % of the compliance are added (as squares) for the masses of the description and the
/// distribution of load between two feet. It stays infinite for a foot whose load changes by at
/// most 20 % of the weight in each stay, or whose compliance exceeds kSoftestSole.
std::vector<SoleSpring> EstimateSoleSprings(const CalibrationResult& result,
                                            const std::vector<FootRest>& rests,
                                            const Eigen::Vector3d& gravity);

}  // namespace elastocal
