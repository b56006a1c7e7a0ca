// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/labels.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Labels that seem exchanged throughout trials, in parts of them, or in postures of a table: those
/// of two clusters, or of two markers.
struct LabelSuspicion {
  std::vector<int> trials = {};    ///< ascending
  std::vector<int> postures = {};  ///< ascending; empty: all of these trials, or of the table
  std::string a, b;                ///< names of the clusters or markers
  std::vector<int> of_a, of_b;     ///< indices of the exchanged markers, in pairs
  /// Deviation of these markers from their positions on the nominal robot, or of their distances
  /// from the nominal ones, as labelled: rms, m.
  double before = 0.0;
  double after = 0.0;  ///< the same with the labels exchanged
};

/// Finds exchanged labels in a recording of trials, if the deviation is far larger than errors of
/// placement. Three cases are examined:
///
/// - two clusters, each of which is where the nominal robot has the other (by at least 50 mm; one
///   of them may be absent in the trial);
/// - two markers of a cluster whose distances to the others are each other's nominal distances (by
///   10 mm);
/// - two markers each of which is where the other should be (FindExchangedMarkers).
///
/// An exchange within a cluster that no other trial contradicts does no harm, because the markers'
/// positions are estimated: only a fit can tell whether the recording fits better without it.
/// `clusters` refer to the markers of the recording. The one that explains most comes first.
std::vector<LabelSuspicion> FindLabelSuspicions(const ErrorModel& model, const Recording& recording,
                                                const std::vector<LabelCluster>& clusters);

/// The recording with these labels exchanged back, in the trials or the table's postures.
Recording WithoutExchange(const Recording& recording, const LabelSuspicion& suspicion);

/// Text such as "the labels of LFOOT and RFOOT are exchanged in trial a, b"; for a part of a trial
/// "... in 10 postures of trial a"; for a table "... in 10 postures", or nothing more.
std::string DescribeSuspicion(const LabelSuspicion& suspicion, const Recording& recording);

}  // namespace elastocal
