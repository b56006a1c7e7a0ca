// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// For each label of a cluster, the raw label from which it gets its position: label i is on raw
/// marker p[i].
using Permutation = std::vector<int>;

/// Distances between the markers of a cluster, m, with one row for each frame and one column for
/// each pair (0,1), (0,2), ..., (1,2), ...; NaN if one of the two markers is not seen.
using DistanceTable = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Column of the pair (i, j), i != j, in the distance table of a cluster of `size` markers.
int PairColumn(int i, int j, int size);

/// Measures the distances between the markers `markers` (indices into the trajectories).
DistanceTable MeasureDistances(const MarkerTrajectories& trajectories,
                               const std::vector<int>& markers);

/// The rigid shape of a cluster, estimated from its own data.
struct ClusterShape {
  int size = 0;
  Eigen::VectorXd
      distances;  ///< most frequent distance of each pair, m; NaN if never seen together
  Eigen::VectorXd tolerances;  ///< of each pair, m

  /// The orders of labels that are tried, the identity first: with up to five markers all orders,
  /// with more only exchanges of two labels.
  std::vector<Permutation> permutations;
  /// Every order except the identity changes some distance by at least this many tolerances.
  double separation = 0.0;

  /// Whether all known distances of a frame fit under `permutation`. Raw marker `without` is left
  /// out (none, if negative).
  bool Fits(const Eigen::Ref<const Eigen::RowVectorXd>& frame, const Permutation& permutation,
            int without = -1) const;
};

/// Measures the shape over some thousands of frames spread over the trial. Distances are medians of
/// the most frequent values (if a marker was displaced within the trial, those of the longer part).
/// Tolerances are `tolerance_sd` standard deviations, but at least `least_tolerance_m`. The
/// standard deviation is estimated from the differences of successive frames (median absolute
/// difference), which neither a swap nor a displaced marker affects.
///
/// `usual`, if not empty, are the distances of the pairs in other trials, m (NaN: unknown). If at
/// least a twentieth of the frames has the usual distance of a pair, the shape takes it, whatever
/// most frames show: a marker was displaced within the trial, or labels were exchanged in most of
/// it. If all frames differ, but another order of the labels has the usual distances, the labels
/// are exchanged in all of the trial, and the shape is the usual one.
ClusterShape MeasureShape(const DistanceTable& table, int size, double tolerance_sd,
                          double least_tolerance_m, const Eigen::VectorXd& usual = {});

/// Median of the values in the interval of the given width that contains the most of them; NaN for
/// no values. If a distance changed in the middle of a trial, the median of all values could lie
/// between the two distances; this one does not.
double DensestMedian(std::vector<double> values, double width);

}  // namespace elastocal
