#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// Which raw label each label of a cluster gets its position from: label i is on raw marker p[i].
using Permutation = std::vector<int>;

/// Distances between the markers of a cluster, m: one row a frame, one column a pair (0,1), (0,2),
/// ..., (1,2), ...; NaN where one of the two is not seen.
using DistanceTable = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Column of the pair (i, j), i != j, in the table of a cluster of `size` markers.
int PairColumn(int i, int j, int size);

DistanceTable MeasureDistances(const MarkerTrajectories& trajectories,
                               const std::vector<int>& markers);

/// A cluster's rigid shape, as found from its own data.
struct ClusterShape {
  int size = 0;
  Eigen::VectorXd distances;   ///< a pair, m, as they mostly are; NaN if never seen together
  Eigen::VectorXd tolerances;  ///< a pair, m
  /// The orders of labels that are looked for, the identity first: all of them up to five markers,
  /// exchanges of two labels beyond.
  std::vector<Permutation> permutations;
  /// The least that any order but the identity changes some distance, in tolerances.
  double separation = 0.0;

  /// Whether all known distances of a frame fit under `permutation`, leaving out raw marker
  /// `without` (none, if negative).
  bool Fits(const Eigen::Ref<const Eigen::RowVectorXd>& frame, const Permutation& permutation,
            int without = -1) const;
};

/// Over some thousands of frames spread over the trial: medians of the most frequent distances
/// (which are those of the longer part, where a marker was knocked within the trial); tolerances of
/// `tolerance_sd` standard deviations, but at least `least_tolerance_m`. The deviation is found
/// from the differences of successive frames (median absolute difference), which neither a swap nor
/// a shifted marker affects.
ClusterShape MeasureShape(const DistanceTable& table, int size, double tolerance_sd,
                          double least_tolerance_m);

}  // namespace elastocal
