// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/observation/observed_robot.hpp"

namespace elastocal {

/// Mistakes in tables of observations that are far larger than errors of a robot: the sign of a
/// joint, rows that belong to the joints of another row (up to two further or before), poses that
/// were written in another convention, and where none of these is one, two joints or two
/// instruments exchanged. Each is undone and the nominal robot placed anew among what it
/// sees, in two dozen postures; it is a mistake if a tenth of the squares is left (of each kind of
/// row over LargestError), and less than twice what the best one leaves.
///
/// Before all, plates that touch two tables in one file are named (FindTwoTables).
///
/// First, up to three rows (one in ten) that contradict all others are named: whatever is tried on
/// all rows would be judged by them.
///
/// Where no mistake explains all rows, those of a file alone are looked at, if another file is
/// sound, and those of a file from some row on, if the rows before are.
///
/// In words, the best first: "j4: the sign of its positions is reversed (--accept sign:j4 corrects
/// it)". For a recording that no robot explains: a clean one has none, but the search fits some
/// hundred times.
std::vector<std::string> FindObservedMistakes(const ObservedRobot& model,
                                              const Observations& observations);

}  // namespace elastocal
