// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// A posture table whose markers belong to the joint positions of another row: a row was lost when
/// the file of the robot and that of the tracker were joined.
struct RowShift {
  int rows = 0;         ///< the markers of row i belong to the joints of row i + rows
  int from = 0;         ///< from this posture on, to the end of the table
  double before = 0.0;  ///< how far markers are from the nominal robot there, m
  double after = 0.0;   ///< the same once the shift is undone, m
};

/// The shift of at most three rows that explains a table best. It is one if the nominal robot's
/// markers, with the root link best placed, are off by 20 mm or more from some posture on, and by
/// less than 0.6 of that once the rows are shifted back, while the postures before it fit as they
/// are. The shift may begin in the first three quarters of the table. A suspicion is no proof.
/// Nothing for a recording of trials.
std::optional<RowShift> FindRowShift(const ErrorModel& model, const Recording& recording);

/// Postures whose markers belong to no row of the table, ascending.
std::vector<int> WithoutPartner(const RowShift& shift, const Recording& recording);

/// The recording with markers and joints of the same postures together again, without the postures
/// that have no partner.
Recording WithoutShift(const Recording& recording, const RowShift& shift);

/// "markers belong to the joint positions of the next row, from line 12 on"
std::string DescribeShift(const RowShift& shift, const Recording& recording);

}  // namespace elastocal
