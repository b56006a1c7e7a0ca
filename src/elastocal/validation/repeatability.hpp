#pragma once

#include <vector>

#include "elastocal/measurement/recording.hpp"

namespace elastocal {

struct RepeatabilityOptions {
  /// Postures are the same where no joint differs by more, rad or m. Above what the controller
  /// leaves, well below the distance of postures that differ.
  double same_posture = 0.01;
  /// Consecutive samples of the same posture belong to one repetition if they are no further apart,
  /// s. Without times, every sample is a repetition.
  double longest_hold_gap_s = 1.0;
  /// Entries of the position vector to compare; empty: all.
  std::vector<int> coordinates = {};
};

/// A static posture that the robot took several times.
struct RepeatedPosture {
  /// By repetition, in order of time: the samples (postures of the recording) that were averaged.
  std::vector<std::vector<int>> samples;
  std::vector<int> waist_markers, effector_markers;  ///< seen in all repetitions: used
  Eigen::VectorXd distances;                         ///< between the two centres, by repetition, m
};

/// How well the robot returns to a posture, as far as the distance between two clusters of markers
/// tells (section 6.1.1 of the paper: 0.066 +- 0.040 mm for the legs, 0.041 +- 0.016 mm for the
/// arms).
struct Repeatability {
  std::vector<RepeatedPosture> postures;  ///< with at least two repetitions
  int repetitions = 0;                    ///< of all these postures together
  /// Mean and standard deviation of the absolute deviations of the distances from the mean of their
  /// posture, m: the paper's figure. NaN where nothing was repeated. Deviations from the mean of n
  /// repetitions are smaller than those from the truth, by sqrt((n - 1) / n).
  double mean_deviation = 0.0, sd_deviation = 0.0;
  /// Standard deviation of a distance about its posture's true mean, unbiased for that, m.
  double distance_sd = 0.0;
  /// What of `distance_sd` the cameras' noise explains: the scatter of the samples within
  /// repetitions over the root of their number, m; NaN where no repetition has two. A robot is not
  /// shown to repeat better than this.
  double noise_sd = 0.0;
  int not_repeated = 0;  ///< postures with fewer than two usable repetitions
  int left_out = 0;      ///< repetitions in which too few markers were seen
};

/// Finds repeated postures among all samples of a recording (of one trial, or of trials in which
/// the markers kept their places; choose with SelectPostures) by their joint positions, and
/// compares the distances between the centres of two clusters of markers, given as indices into the
/// recording's.
///
/// Markers are averaged over the samples of a repetition. A centre means something only if it is of
/// the same markers each time: a repetition that shows fewer than half of the markers of a cluster
/// is left out, and of the others only the markers seen in all repetitions of a posture count; a
/// posture without such markers counts as not repeated. Throws std::invalid_argument for a cluster
/// without markers or with one that the recording does not have.
Repeatability AssessRepeatability(const Recording& recording, const std::vector<int>& waist_markers,
                                  const std::vector<int>& effector_markers,
                                  const RepeatabilityOptions& options);

}  // namespace elastocal
