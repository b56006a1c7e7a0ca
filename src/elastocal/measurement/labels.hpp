#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/cluster_shape.hpp"
#include "elastocal/measurement/frame_interval.hpp"
#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// Markers fixed to one rigid plate or cover, whose labels the cameras' software may exchange.
struct LabelCluster {
  std::string name;
  std::vector<int> markers;  ///< of the trajectories' names
};

struct LabelOptions {
  double tolerance_sd = 6.0;          ///< a distance is off beyond this many standard deviations
  double least_tolerance_m = 0.0015;  ///< ... and this: cameras err differently across their space
  /// Labels are only put right if every other order changes some distance by this many tolerances:
  /// above 2, no frame can fit two orders.
  double least_separation = 2.5;
};

/// Frames in which labels were exchanged, now corrected.
struct SwappedLabels {
  FrameInterval frames;
  Permutation permutation;  ///< label i of the cluster is now where label permutation[i] was
};

/// Frames in which a marker was set to NaN, as its distances to the others were off.
struct OutlyingMarker {
  FrameInterval frames;
  int marker = 0;  ///< of the trajectories' names
};

struct ClusterLabels {
  std::string name;
  std::vector<int> markers;  ///< of the trajectories' names, as the cluster's
  /// Exchanged labels cannot be put right for certain: one or two markers, or distances much alike.
  /// Positions that look exchanged are then removed, as outliers are.
  bool ambiguous = false;
  Eigen::VectorXd distances;   ///< a pair of markers, m, as ClusterShape
  Eigen::VectorXd tolerances;  ///< m
  std::vector<SwappedLabels> swaps;
  std::vector<OutlyingMarker> outliers;
  std::vector<FrameInterval>
      undecided;  ///< frames of an ambiguous cluster that look exchanged; removed
};

/// Finds and corrects exchanged labels within clusters, and removes outlying markers, in place, by
/// the distances between the markers of a cluster, which are constant. To be run on raw positions,
/// before gaps are filled.
///
/// A frame whose distances are off is given the one order of labels under which all fit. Where a
/// marker is hidden, the order of the nearest frames before and after decides, if it fits. Where no
/// order fits, the one marker without which the others fit is removed; where several would do, all
/// of these; where none does, or two orders do, all of the cluster. Clusters of one marker are not
/// looked at. Linear in the number of frames.
///
/// Throws std::invalid_argument for a marker out of range or listed twice in a cluster.
std::vector<ClusterLabels> CorrectLabels(const std::vector<LabelCluster>& clusters,
                                         const LabelOptions& options,
                                         MarkerTrajectories& trajectories);

}  // namespace elastocal
