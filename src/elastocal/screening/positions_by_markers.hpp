// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Positions of the joints by the markers, for each posture of a recording of trials (postures x
/// coordinates). They bring the nominal markers nearest to the measured ones, with the waist free
/// and the log as a weak prior (0.5 rad or 0.1 m; a marker has 20 mm, or 1 % of RobotSize for a
/// robot smaller than 2 m). Positions that the markers do not show stay as logged. Where the
/// markers are far from the log (twice that), the search begins with the one reversed sign, or
/// exchange of two joints, that brings them nearest.
Eigen::MatrixXd PositionsByMarkers(const ErrorModel& model, const Recording& recording);

}  // namespace elastocal
