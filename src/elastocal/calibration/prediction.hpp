// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "elastocal/calibration/options.hpp"
#include "elastocal/calibration/placement.hpp"

namespace elastocal {

/// Where a model says that the markers of a recording are.
struct Prediction {
  /// Where each marker should be, in the frame of the recording, m: postures x 3 N_M, as
  /// Recording::markers; NaN where the waist could not be placed. Also of markers not seen.
  Eigen::MatrixXd positions;
  /// Distances between measured and predicted positions, m: postures x markers; NaN where a marker
  /// was not seen or the waist could not be placed.
  Eigen::MatrixXd distances;
  /// Where the model says that the robot stood: the waist of each posture as the leg on its foot
  /// gives it. Empty where the waist does not move.
  Placement placement;
};

/// By which markers a footing is placed.
enum class FootingBy {
  kAllMarkers,  ///< of the trial: what explains the trial best
  /// Those on the foot alone: where the waist is with respect to its foot then shows. Where fewer
  /// than three of them were seen, all.
  kFootMarkers,
  /// As kAllMarkers, and a root that is free in a posture by all its markers: what the robot's
  /// joints leave then shows beside the noise of few markers, which long levers magnify.
  kAllOfPosture,
};

/// Predicts the markers of a recording by a model with errors `delta`, as a user of the robot
/// would: nothing is fitted to a single posture that the robot does not know itself.
///
/// Where the robot stands on one foot, or its root is held, the pose of that footing is constant
/// (fitted to all its postures in closed form, or taken from `footings` where the same footing is
/// there) and the elastic leg carries the waist, eq. 6. On two feet the waist is placed by its own
/// markers alone (three or more), as in section 6 for head, arms and trunk; a free root by
/// PlacingMarkers. In a table of postures whose root is held, the waist is where T0 says.
Prediction Predict(const ErrorModel& model, const Eigen::VectorXd& delta,
                   const Recording& recording, const CalibrationOptions& options,
                   const Placement* footings = nullptr, FootingBy by = FootingBy::kAllMarkers);

}  // namespace elastocal
