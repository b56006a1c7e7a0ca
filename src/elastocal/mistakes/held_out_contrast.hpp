// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/labels.hpp"
#include "elastocal/mistakes/moved_between.hpp"
#include "elastocal/screening/recording_fault.hpp"
#include "elastocal/validation/error_table.hpp"

namespace elastocal {

inline constexpr double kSuspicious = 3.0;  ///< ratio to the error on the trials of the estimate
/// Share of the uncalibrated error. A fit that is better than this on postures at rest is not
/// expected to be as good in motion, which statics does not describe.
inline constexpr double kBestExpected = 0.03;

/// Errors of the largest model on markers in the trials of the estimate and in held-out ones, and
/// that of the uncalibrated robot in the former, m.
struct Contrast {
  std::string name;  ///< group of chains (TrialGroups) or cluster; empty: none
  double fitted = 0.0, uncalibrated = 0.0, held_out = 0.0;
  double ratio() const;
};

/// The largest contrast of a group of chains, and that of a cluster, since a neck is a small part
/// of its group.
struct Contrasts {
  Contrast of_groups, of_clusters;
  double largest() const;   ///< the larger ratio
  bool suspicious() const;  ///< a ratio of more than three
};

/// A held-out group is compared with the fitted groups within it, or else with those that share a
/// chain with it.
Contrasts LargestContrasts(const ErrorTable& fitted, const ErrorTable& held_out,
                           const std::vector<LabelCluster>& clusters, ModelKind kind);

/// Clusters that may be displaced in some held-out trials, because their error there exceeds three
/// times that in the trials of the estimate; the worst first. In `all`, the trials of the estimate
/// come first, then the held-out ones.
std::vector<MovedSuspect> MovedSuspects(const std::vector<LabelCluster>& clusters,
                                        const ErrorTable& fitted, const ErrorTable& held_out,
                                        ModelKind kind, const Recording& all);

/// Whether a gain may be due to inertia. In a sinusoidal motion the acceleration is proportional to
/// the position, and so is the deflection by inertia: at half a hertz, a joint with a natural
/// frequency of 5 Hz seems to have a gain of 1 %.
bool MayBeInertia(const RecordingFault& fault, const Recording& recording);

}  // namespace elastocal
