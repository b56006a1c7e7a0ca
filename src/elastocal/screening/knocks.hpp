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

/// A knock: a cluster that was displaced as a whole on its link during the experiment. Distances
/// within the cluster stay, so that only the model of the robot shows it. Or one of its markers was
/// displaced (FindMovedMarkers).
struct Knock {
  std::string cluster;
  /// Markers that were seen on both sides of the knock, each of which becomes two (SplitMarkers).
  /// They are indices in the recording as split by the knocks before this one.
  std::vector<int> markers;
  int posture = 0;            ///< the first posture after the knock in which the cluster was seen
  int last_before = 0;        ///< the last posture before the knock in which the cluster was seen
  double distance = 0.0;      ///< m
  double significance = 0.0;  ///< F statistic of the step over its limit
};

/// Finds knocked clusters in a recording of trials; empty for a posture table. The order of the
/// postures counts as that of time.
///
/// After a least-squares fit of all parameters in `base` (with only a few updates of the noise),
/// each cluster and each posture is tried as a change point: by how much would the cost drop if the
/// cluster were displaced by a constant step, in the axes of its link, from that posture on (Rao's
/// score test)? All else that could explain the step is unknown beside it: joints, markers, feet
/// and the waist of each posture. A cluster on the waist or a foot, which moves the pose on which
/// all others depend, is thus told from these others. The step that explains most is a knock if
/// - its F statistic exceeds what noise makes likely in any of the steps tried, with a probability
///   of CalibrationOptions::outlier_probability;
/// - it is at least 1 mm, because no model of a robot is more exact;
/// - it is at least three times the scatter of the cluster about its two positions (per axis),
///   because a model with different errors in each posture can look like a step.
///
/// The cluster is then split into two (SplitMarkers), and the search is repeated, at most four
/// times.
std::vector<Knock> FindKnocks(const ErrorModel& model, const Recording& recording,
                              const BaseParameters& base, const std::vector<LabelCluster>& clusters,
                              const CalibrationOptions& options);

/// Splits each marker of a knocked cluster into two. The name stays with the observations after the
/// knock, where later recordings see the marker. The observations before it go to a new marker on
/// the same link, `NAME(before)`. New markers are the last ones, so that earlier markers and
/// parameters keep their indices.
void SplitMarkers(const std::vector<Knock>& knocks, ErrorModel& model, Recording& recording);

/// Splits the markers in postures that were left out of the search as SplitMarkers split those of
/// `model`, by the order of time. `searched` and `left_out` are the places of both in the whole
/// recording, ascending. Between the last posture before a knock and the first one after it, the
/// position of the cluster is unknown; there its markers are hidden.
void SplitLeftOut(const std::vector<Knock>& knocks, const ErrorModel& model,
                  const std::vector<int>& searched, const std::vector<int>& left_out,
                  Recording& recording);

/// For each marker of a split recording: its index among the `marker_count` markers before the
/// split.
std::vector<int> MarkersBeforeSplit(const std::vector<Knock>& knocks, int marker_count);

/// Adds the markers that a recording of the model's first markers lacks; they are never seen.
void AddUnseenMarkers(const ErrorModel& model, Recording& recording);

}  // namespace elastocal
