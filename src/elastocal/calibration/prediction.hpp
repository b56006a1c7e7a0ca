// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "elastocal/calibration/options.hpp"
#include "elastocal/calibration/placement.hpp"

namespace elastocal {

/// Predicted positions of the markers of a recording.
struct Prediction {
  /// Predicted position of each marker, also of those not seen, in the frame of the recording, m:
  /// postures x 3 N_M, as Recording::markers. NaN where the waist could not be placed.
  Eigen::MatrixXd positions;
  /// Distances between measured and predicted positions, m: postures x markers; NaN where a marker
  /// was not seen or the waist could not be placed.
  Eigen::MatrixXd distances;
  /// Predicted poses: the waist of each posture as the leg on its foot gives it. Empty where the
  /// waist does not move.
  Placement placement;
};

/// Markers that place a footing.
enum class FootingBy {
  kAllMarkers,  ///< all markers of the trial, which explains the trial best
  /// The markers on the foot alone, so that errors of the waist relative to its foot show. All
  /// markers where fewer than three of these were seen.
  kFootMarkers,
  /// As kAllMarkers; but a free root is placed in each posture by all its markers. The residuals
  /// then show what the joints leave, without the noise of few markers at long levers.
  kAllOfPosture,
};

/// Predicts the markers of a recording by a model with errors `delta`, as a user of the robot
/// would: nothing is fitted to a single posture that the robot does not know itself.
///
/// Where the robot stands on one foot, or its root is held, that footing has a constant pose, and
/// the elastic leg carries the waist, eq. 6. The pose is fitted to all postures of the footing in
/// closed form, or taken from `footings` if the same footing (trial and leg) is there. On two feet
/// the waist is placed by its own markers alone (three or more), as in section 6 for head, arms and
/// trunk; a free root is placed by PlacingMarkers. In a posture table whose root is held, T0 places
/// the waist.
Prediction Predict(const ErrorModel& model, const Eigen::VectorXd& delta,
                   const Recording& recording, const CalibrationOptions& options,
                   const Placement* footings = nullptr, FootingBy by = FootingBy::kAllMarkers);

}  // namespace elastocal
