// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "elastocal/calibration/options.hpp"
#include "elastocal/recorded/measurements.hpp"
#include "elastocal/validation/transfer.hpp"

namespace elastocal {

/// Factor by which measured markers appear larger than predicted ones (postures x 3 N_M, m; NaN
/// where unknown): the scale of the similarity transform that brings the predictions nearest to
/// them. The predictions are already placed, with one pose for all postures or one for each
/// (HasPoseByPosture). 1 without markers.
double ScaleOfMarkers(const Recording& recording, const Eigen::MatrixXd& predicted);

/// Operations on the calibration that a few postures test.
struct CheckedCalibration {
  /// Fits waist and markers, with the joints as calibrated.
  std::function<Refit(const Recording&)> refit;
  /// Whether the calibration explains a recording without a joint that has moved.
  std::function<bool(const Measurements&)> holds;
};

/// Finds a wrong scale of the cameras, and a wrong gain of one joint's positions, with which
/// corrected the calibration holds: moved joints may look like these. Returns sentences that name
/// the correction. `recording` has the markers of the refit's model, to which those of
/// `as_recorded` are converted.
std::vector<std::string> FindAlternatives(const CheckedCalibration& calibration,
                                          const Recording& recording,
                                          const Measurements& as_recorded, const Project& project);

}  // namespace elastocal
