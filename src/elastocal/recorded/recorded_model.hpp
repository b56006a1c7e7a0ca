// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/recorded/measurements.hpp"
#include "elastocal/screening/knocks.hpp"
#include "elastocal/screening/torque_check.hpp"

namespace elastocal {

/// The model of a robot for a recording.
struct RecordedModel {
  ErrorModel model;                ///< with the recording's markers
  BaseParameters base;             ///< base parameters with these markers
  std::vector<Knock> knocks = {};  ///< found in the recording; their clusters are split into two
  std::vector<ContradictoryTorque> contradictory = {};  ///< torque sensors that are not used
};

/// The clusters of the project (RigidClusters) with the markers that the recording has, as indices
/// of its markers.
std::vector<LabelCluster> SeenClusters(const Project& project, const Recording& recording);

enum class KnockSearch { kAll, kNone };

/// Makes the error model of the robot with the markers of `measured.calibration` (eq. 2, 3, 5 and
/// 6), and finds its identifiable parameters (section 2.1) and the clusters that were knocked
/// during the experiment. For a knocked cluster, `measured` gets separate markers before and after
/// (SplitMarkers). Its warnings name knocks, and parameters that these markers cannot identify.
/// `seed` replaces the project's.
RecordedModel MakeRecordedModel(const Project& project, std::optional<std::uint64_t> seed,
                                Measurements& measured, KnockSearch search = KnockSearch::kAll);

}  // namespace elastocal
