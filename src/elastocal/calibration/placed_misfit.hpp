// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Root mean square over the markers of the median distance of each, m: a mistake of one joint
/// moves few markers, a wrong sighting is one of many. 0 without any.
double TypicalDistance(const std::vector<std::vector<double>>& by_marker);

/// How far the markers of a posture table typically are from those of the nominal robot once its
/// root link (a free one in each posture) and each marker on its link are where they fit best, m
/// (TypicalDistance). Errors of a robot leave millimetres;
/// nothing is estimated of them, so that a mistake in the table is not taken for one. Of a long
/// table some postures are taken, evenly spread. 0 without markers.
double PlacedMisfit(const ErrorModel& model, const Recording& recording);

}  // namespace elastocal
