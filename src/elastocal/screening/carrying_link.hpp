// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/measurement/labels.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// A cluster whose markers move with another link than the project says.
struct CarryingLink {
  /// Name of the cluster, of its link in the project, and of the link with which it moves.
  std::string cluster, own, carrier;
  /// Rms distance of its markers from their mean positions in the frame of `own`, m.
  double on_own = 0.0;
  /// The same in the frame of `carrier`, m.
  double on_carrier = 0.0;
};

/// Finds the cluster of two markers or more whose positions scatter by at least 20 mm in the frame
/// of their own link, and by at most a third of that in the frame of another link of the nominal
/// robot. The root link is placed by the other clusters, in postures in which three of their
/// markers are seen. Nothing where several clusters meet this rule: then a joint's positions are
/// wrong.
std::optional<CarryingLink> FindCarryingLink(const ErrorModel& model, const Recording& recording,
                                             const std::vector<LabelCluster>& clusters);

/// Text such as "cluster FOREARM: its markers move with upper_arm (3.14 mm rms), not with forearm
/// (85.1 mm rms): on which link are they?".
std::string Describe(const CarryingLink& found);

}  // namespace elastocal
