// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/calibration/options.hpp"
#include "elastocal/identifiability/base_parameters.hpp"
#include "elastocal/measurement/labels.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// A cluster of markers that was displaced as a whole during the experiment, against the link that
/// carries it. Distances within the cluster stay, so that only the model of the robot can tell. Or
/// one marker of it (FindMovedMarkers).
struct Knock {
  std::string cluster;
  /// Those seen on both sides of it, which become two (SplitMarkers): indices in the recording as
  /// split by the knocks before this one.
  std::vector<int> markers;
  int posture = 0;            ///< the first one after it in which the cluster was seen
  int last_before = 0;        ///< the last one before it in which the cluster was seen
  double distance = 0.0;      ///< m
  double significance = 0.0;  ///< F of the step, over the value that it has to exceed
};

/// Looks for knocked clusters in a recording of trials (in a table of postures for none). The order
/// of the postures is taken for that of time.
///
/// After a least-squares fit of all parameters in `base` (a few updates of the noise only), each
/// cluster and each posture is tried as a change point: by how much the cost would drop if the
/// cluster were displaced by a constant step, in the axes of its link, from that posture on (Rao's
/// score test). All else that could explain the step is unknown beside it: joints, markers, feet
/// and the waist of each posture, so that a cluster on the waist or a foot, which moves the pose
/// that all others hang on, is told from these others. The split that explains most is a knock if
/// - its F statistic is beyond what noise makes likely in any of the splits tried, but for a chance
///   of CalibrationOptions::outlier_probability;
/// - it is at least 1 mm, which no model of a robot should be believed below;
/// - it is at least three times the scatter of the cluster about its two positions (per axis), as a
///   model that is wrong by a different amount in each posture can look like a step.
/// Then the cluster is taken as two (SplitMarkers), and the search repeated: at most four times.
std::vector<Knock> FindKnocks(const ErrorModel& model, const Recording& recording,
                              const BaseParameters& base, const std::vector<LabelCluster>& clusters,
                              const CalibrationOptions& options);

/// Makes two of each marker of a knocked cluster. The name stays with the data after the knock:
/// that is where later recordings see it. What was seen before goes to a new marker on the same
/// link, `NAME(before)`. The new ones come last, so that earlier markers keep their indices and all
/// parameters theirs.
void SplitMarkers(const std::vector<Knock>& knocks, ErrorModel& model, Recording& recording);

/// Splits the markers of postures that were left out of the search as SplitMarkers has split those
/// of `model`, by the order of time. `searched`, `left_out`: the places of both in the whole
/// recording, ascending. Between the last posture before a knock and the first one after it, nobody
/// knows where the cluster was: there, its markers are not seen.
void SplitLeftOut(const std::vector<Knock>& knocks, const ErrorModel& model,
                  const std::vector<int>& searched, const std::vector<int>& left_out,
                  Recording& recording);

/// By marker of a recording that was split: which of the `marker_count` before it is.
std::vector<int> MarkersBeforeSplit(const std::vector<Knock>& knocks, int marker_count);

/// For a recording of the model's first markers: those that it lacks, never seen.
void AddUnseenMarkers(const ErrorModel& model, Recording& recording);

}  // namespace elastocal
