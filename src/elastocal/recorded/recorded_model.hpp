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

/// The model of a robot as a recording shows it.
struct RecordedModel {
  ErrorModel model;                ///< with the recording's markers
  BaseParameters base;             ///< of these
  std::vector<Knock> knocks = {};  ///< found in the recording; their clusters are taken as two
  std::vector<ContradictoryTorque> contradictory = {};  ///< sensors that are not used
};

/// The project's clusters as far as their markers are in the recording, by its columns.
std::vector<LabelCluster> SeenClusters(const Project& project, const Recording& recording);

enum class KnockSearch { kAll, kNone };

/// The error model of the robot with the markers of `measured.calibration` (eq. 2, 3, 5 and 6), its
/// identifiable parameters (section 2.1), and the clusters of markers that were knocked during the
/// experiment. For a knocked cluster, `measured` gets separate markers for before and after
/// (SplitMarkers). Its warnings name knocks, and parameters that these markers cannot identify.
/// `seed` is taken instead of the project's.
RecordedModel MakeRecordedModel(const Project& project, std::optional<std::uint64_t> seed,
                                Measurements& measured, KnockSearch search = KnockSearch::kAll);

}  // namespace elastocal
