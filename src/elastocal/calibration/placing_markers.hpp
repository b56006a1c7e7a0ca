// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Nominal positions of a body's markers in its frame, 3 x markers, m.
Eigen::Matrix3Xd MarkersOnBody(const ErrorModel& model, int body);

/// The markers that place the waist of a posture that nothing ties to the floor, so that the other
/// markers can be predicted: the seen ones on the root link. If the root is free and these do not
/// determine its pose, those on the nearest body (by number of joints) whose markers do. Empty:
/// there are none.
std::vector<int> PlacingMarkers(const ErrorModel& model, const Recording& recording, int posture);

}  // namespace elastocal
