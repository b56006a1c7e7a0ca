// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Positions of all markers of a recording on the nominal robot in one posture, m (3 x markers), in
/// the root link's frame.
struct NominalPosture {
  int posture = 0;
  Eigen::Matrix3Xd markers;
};

/// At most `most` postures of a trial (-1: of all trials), evenly spread. `model` has the
/// recording's markers.
std::vector<NominalPosture> NominalPostures(const ErrorModel& model, const Recording& recording,
                                            int trial, std::size_t most);

/// Pose of the root link in the frame of the markers, by the markers that are seen and not in
/// `without`. Nothing where fewer than three are left.
std::optional<Transform> PlaceRoot(const Recording& recording, const NominalPosture& nominal,
                                   const std::vector<int>& without);

}  // namespace elastocal
