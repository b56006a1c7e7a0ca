// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "elastocal/calibration/options.hpp"
#include "elastocal/recorded/measurements.hpp"
#include "elastocal/validation/transfer.hpp"

namespace elastocal {

/// By which factor measured markers seem larger than predicted ones (postures x 3 N_M, m; NaN where
/// unknown): that of the similarity that brings these nearest to them, the predictions being placed
/// already, one pose for all postures or one for each (HasPoseByPosture). 1 without markers.
double ScaleOfMarkers(const Recording& recording, const Eigen::MatrixXd& predicted);

/// What is asked of a calibration that a few postures test.
struct CheckedCalibration {
  /// Waist and markers refitted, the joints as calibrated.
  std::function<Refit(const Recording&)> refit;
  /// Whether it explains a recording without a joint that has moved.
  std::function<bool(const Measurements&)> holds;
};

/// A wrong scale of the cameras, and a wrong gain of one joint's positions, each if the calibration
/// holds once it is corrected: moved joints may look like these. In words, with what corrects
/// them. `recording`: with the markers of the refit's model, which those of `as_recorded` become.
std::vector<std::string> FindAlternatives(const CheckedCalibration& calibration,
                                          const Recording& recording,
                                          const Measurements& as_recorded, const Project& project);

}  // namespace elastocal
