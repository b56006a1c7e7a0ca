// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/labels.hpp"
#include "elastocal/mistakes/moved_between.hpp"
#include "elastocal/screening/recording_fault.hpp"
#include "elastocal/validation/error_table.hpp"

namespace elastocal {

inline constexpr double kSuspicious = 3.0;  ///< times the error on the trials of the estimate
/// Of the uncalibrated error: a fit that is better than this on postures at rest is not expected to
/// be as good in motion, which statics does not describe.
inline constexpr double kBestExpected = 0.03;

/// A group of chains whose held-out trials the largest model predicts worse than it fits those of
/// the estimate.
struct Contrast {
  std::string group;
  double fitted = 0.0, uncalibrated = 0.0, held_out = 0.0;  // m
  double largest_of_clusters = 0.0;                         // of the ratios of all clusters
  double ratio() const;
  bool suspicious() const;  ///< by a factor of three
};

/// The largest one, of the groups and of the clusters: a neck is a small part of what it moves
/// with.
Contrast LargestContrast(const ErrorTable& fitted, const ErrorTable& held_out,
                         const std::vector<LabelCluster>& clusters, ModelKind kind);

/// Clusters whose markers the model has elsewhere in some held-out trials, by three times its error
/// on those of the estimate, the worst first: in `all`, the trials of the estimate come first, and
/// then the held-out ones.
std::vector<MovedSuspect> MovedSuspects(const std::vector<LabelCluster>& clusters,
                                        const ErrorTable& fitted, const ErrorTable& held_out,
                                        ModelKind kind, const Recording& all);

/// In a sine the acceleration is proportional to the position, and so is what inertia bends: at
/// half a hertz, a joint that would swing at 5 Hz seems to have a gain of 1 % in such a trial.
bool MayBeInertia(const RecordingFault& fault, const Recording& recording);

}  // namespace elastocal
