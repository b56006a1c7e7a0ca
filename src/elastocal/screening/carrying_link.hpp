// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/measurement/labels.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// A cluster that moves with another link than that of the project.
struct CarryingLink {
  std::string cluster, own, carrier;  ///< the links' names
  double on_own = 0.0;  ///< rms distance of its markers from their mean positions there, m
  double on_carrier = 0.0;
};

/// The cluster whose markers, seen from another link of the nominal robot, scatter by a third at
/// most of what they do on their own one, where that is at least 20 mm. The root link is placed by
/// the other clusters, in postures in which three of their markers are seen. None where that is so
/// of several clusters: a joint's positions are wrong then.
std::optional<CarryingLink> FindCarryingLink(const ErrorModel& model, const Recording& recording,
                                             const std::vector<LabelCluster>& clusters);

/// "cluster FOREARM: its markers move with upper_arm (3.14 mm rms), not with forearm (85.1 mm rms):
/// on which link are they?"
std::string Describe(const CarryingLink& found);

}  // namespace elastocal
