// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Positions of the joints as the markers show them: in each posture of a recording of trials,
/// those that bring the nominal markers nearest to the measured ones, the waist being free, with
/// the log as a weak prior (0.5 rad or 0.1 m; a marker has 20 mm, of a robot that is smaller than
/// 2 m 1 % of RobotSize). What the markers do not show is as logged. Where the markers are far from
/// the log (twice that), the search begins where one reversed sign or one exchange of two joints
/// would bring them nearest. postures x coordinates.
Eigen::MatrixXd PositionsByMarkers(const ErrorModel& model, const Recording& recording);

}  // namespace elastocal
