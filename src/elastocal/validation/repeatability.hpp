// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/measurement/recording.hpp"

namespace elastocal {

/// Settings of AssessRepeatability.
struct RepeatabilityOptions {
  /// Two postures are the same if no joint differs by more than this, rad or m. The value is above
  /// the controller's error and well below the distance between different postures.
  double same_posture = 0.01;
  /// Consecutive samples of the same posture belong to one repetition if they are at most this far
  /// apart, s. Without times, every sample is a repetition.
  double longest_hold_gap_s = 1.0;
  /// Entries of the position vector that are compared; empty: all.
  std::vector<int> coordinates = {};
};

/// A static posture that the robot took several times.
struct RepeatedPosture {
  /// For each repetition, in order of time: the samples (postures of the recording) that were
  /// averaged.
  std::vector<std::vector<int>> samples;
  /// Markers used: those seen in all repetitions.
  std::vector<int> waist_markers, effector_markers;
  Eigen::VectorXd distances;  ///< distance between the two centres, by repetition, m
};

/// How exactly the robot returns to a posture, by the distance between the centres of two clusters
/// (section 6.1.1 of the paper: 0.066 +- 0.040 mm for the legs, 0.041 +- 0.016 mm for the arms).
struct Repeatability {
  std::vector<RepeatedPosture> postures;  ///< postures with at least two repetitions
  int repetitions = 0;                    ///< sum over these postures
  /// Mean and standard deviation of the absolute deviations of the distances from the mean of their
  /// posture, m; these are the paper's figures. NaN if nothing was repeated. Deviations from the
  /// mean of n repetitions are smaller than deviations from the truth by a factor sqrt((n - 1) /
  /// n).
  double mean_deviation = 0.0, sd_deviation = 0.0;
  /// Standard deviation of a distance about the true mean of its posture (unbiased), m.
  double distance_sd = 0.0;
  /// Share of `distance_sd` that the noise of the cameras explains, m: the scatter of the samples
  /// within repetitions over the root of their number. NaN if no repetition has two samples. A
  /// repeatability below this value cannot be measured.
  double noise_sd = 0.0;
  int not_repeated = 0;  ///< postures with fewer than two usable repetitions
  int left_out = 0;      ///< repetitions in which too few markers were seen
};

/// Finds repeated postures among all samples of a recording by their joint positions, and compares
/// the distances between the centres of two clusters of markers (indices into the recording's
/// markers). The recording must be of one trial, or of trials in which the markers kept their
/// places (see SelectPostures).
///
/// Markers are averaged over the samples of a repetition. Centres can be compared only if they are
/// of the same markers. A repetition that shows fewer than half of the markers of a cluster is
/// therefore left out; of the others, only the markers seen in all repetitions of a posture are
/// used. A posture without such markers counts as not repeated. Throws std::invalid_argument for a
/// cluster without markers, or with one that the recording does not have.
Repeatability AssessRepeatability(const Recording& recording, const std::vector<int>& waist_markers,
                                  const std::vector<int>& effector_markers,
                                  const RepeatabilityOptions& options);

}  // namespace elastocal
