// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/screening/log_check.hpp"

namespace elastocal {

/// Postures of the trials whose markers contradict a reversed sign of a joint: they show it
/// (PositionsByMarkers) farther from its position with the sign undone than from the logged one. Of
/// a joint that moves in the trial, motions are compared. Ascending; empty for other mistakes and
/// for motors of rods. A trial whose markers do not show the joint contradicts nothing.
std::vector<int> PosturesAgainst(const ErrorModel& model, const LogSuspicion& sign,
                                 const Recording& recording);

}  // namespace elastocal
