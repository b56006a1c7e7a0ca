// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/labels.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Labels that seem exchanged throughout trials, in parts of them or in postures of a table: those
/// of two clusters, or of two markers.
struct LabelSuspicion {
  std::vector<int> trials = {};    ///< ascending
  std::vector<int> postures = {};  ///< ascending; empty: all of these trials, or of the table
  std::string a, b;                ///< names of the clusters or markers
  std::vector<int> of_a, of_b;     ///< markers of the recording, one by one
  double before = 0.0;  ///< of these from where the nominal robot has them, or from their nominal
  double after = 0.0;   ///< distances; once they are exchanged. rms, m
};

/// Exchanged labels that are far from any error of placement, in a recording of trials: two
/// clusters each of which is where the nominal robot has the other (by at least 50 mm; one of them
/// may not be part of the trial), or two
/// markers of a cluster whose distances to the others are each other's nominal ones (by 10 mm), or
/// two markers each of which is where the other should be (FindExchangedMarkers). An exchange
/// within a cluster that no other trial shows does no harm, because the markers' positions are
/// estimated: whether the recording fits better without it, a fit has to say. `clusters` refer to
/// the markers of the recording. The one that explains most first.
std::vector<LabelSuspicion> FindLabelSuspicions(const ErrorModel& model, const Recording& recording,
                                                const std::vector<LabelCluster>& clusters);

/// The recording with these labels exchanged back, in the trials or the table's postures.
Recording WithoutExchange(const Recording& recording, const LabelSuspicion& suspicion);

/// "the labels of LFOOT and RFOOT are exchanged in trial a, b"; of a part of a trial "... in 10
/// postures of trial a"; of a table "... in 10 postures", or nothing more.
std::string DescribeSuspicion(const LabelSuspicion& suspicion, const Recording& recording);

}  // namespace elastocal
