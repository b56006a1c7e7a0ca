// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// A shift of rows in a posture table: markers belong to the joint positions of another row,
/// because a row was lost when the files of robot and tracker were joined.
struct RowShift {
  int rows = 0;         ///< markers of row i belong to the joints of row i + rows
  int from = 0;         ///< the first posture with the shift, which lasts to the end of the table
  double before = 0.0;  ///< distance of the markers from the nominal robot there, m
  double after = 0.0;   ///< the same with the shift corrected, m
};

/// Finds the shift of at most three rows that explains a table best. The root link is placed best;
/// from some posture on, the nominal robot's markers are off by at least 20 mm (1.5 % of RobotSize
/// for a small robot), and by less than 0.6 of that with the rows shifted back, while the postures
/// before fit as they are. The shift may begin in the first three quarters of the table. A
/// suspicion is no proof. Nothing for a recording of trials.
std::optional<RowShift> FindRowShift(const ErrorModel& model, const Recording& recording);

/// Postures whose markers belong to no row of the table, ascending.
std::vector<int> WithoutPartner(const RowShift& shift, const Recording& recording);

/// The recording in which markers and joints of the same posture are together again, without the
/// postures that have no partner.
Recording WithoutShift(const Recording& recording, const RowShift& shift);

/// Text such as "markers belong to the joint positions of the next row, from line 12 on".
std::string DescribeShift(const RowShift& shift, const Recording& recording);

}  // namespace elastocal
