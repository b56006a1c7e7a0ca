// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "elastocal/measurement/cluster_shape.hpp"
#include "elastocal/measurement/frame_interval.hpp"
#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// Markers on one rigid part, whose labels the cameras' software may exchange.
struct LabelCluster {
  std::string name;
  std::vector<int> markers;  ///< indices into the trajectories' names
};

/// Distances between two markers of a cluster, m, by their names in the order of the cluster.
using PairDistances = std::map<std::pair<std::string, std::string>, double>;

struct LabelOptions {
  double tolerance_sd = 6.0;  ///< tolerance of a distance in standard deviations
  double least_tolerance_m =
      0.0015;  ///< least tolerance of a distance, m: errors of cameras vary in space
  /// Labels are corrected only if every other order changes some distance by this many tolerances.
  /// Above 2, no frame can fit two orders.
  double least_separation = 2.5;
  PairDistances usual = {};  ///< distances that other trials show (MeasureShape)
};

/// Frames in which labels were exchanged, now corrected.
struct SwappedLabels {
  FrameInterval frames;
  Permutation permutation;  ///< label i of the cluster is now where label permutation[i] was
};

/// Frames in which a marker was set to NaN because its distances to the others were wrong.
struct OutlyingMarker {
  FrameInterval frames;
  int marker = 0;  ///< index into the trajectories' names
};

struct ClusterLabels {
  std::string name;
  std::vector<int> markers;  ///< indices into the trajectories' names, in the order of the cluster
  /// Exchanged labels cannot be corrected with certainty, because the cluster has only one or two
  /// markers or its distances are too much alike. Positions that look exchanged are then removed
  /// like outliers.
  bool ambiguous = false;
  Eigen::VectorXd distances;   ///< of each pair of markers, m, as in ClusterShape
  Eigen::VectorXd tolerances;  ///< m
  std::vector<SwappedLabels> swaps;
  std::vector<OutlyingMarker> outliers;
  std::vector<FrameInterval>
      undecided;  ///< frames of an ambiguous cluster that look exchanged; removed
};

/// Finds and corrects exchanged labels within clusters and removes outlying markers, in place. It
/// uses that the distances between the markers of a cluster are constant. Run it on raw positions,
/// before gaps are closed.
///
/// A frame whose distances are wrong gets the one order of labels under which all distances fit. If
/// a marker is hidden, the order of the nearest frames before and after is taken, if it fits. If no
/// order fits, the one marker without which the others fit is removed. If there are several such
/// markers, all of these are removed; if there is none, or if two orders fit, the whole cluster is.
/// Clusters of one marker are skipped. In an ambiguous cluster, frames between two jumps of markers
/// to each other's places, at most 2 s apart, look exchanged even where their distances fit. Time
/// is linear in the number of frames.
///
/// Throws std::invalid_argument for a marker out of range or listed twice in a cluster.
std::vector<ClusterLabels> CorrectLabels(const std::vector<LabelCluster>& clusters,
                                         const LabelOptions& options,
                                         MarkerTrajectories& trajectories);

}  // namespace elastocal
