// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/observation/observed_robot.hpp"

namespace elastocal {

/// Finds mistakes in tables of observations that are far larger than errors of a robot: the
/// reversed sign of a joint, rows that belong to the joints of another row (up to two further or
/// before), poses written in another convention, and, if none of these is found, two joints or two
/// instruments exchanged. Each mistake is corrected and the nominal robot placed again by its
/// observations, in two dozen postures. It is a mistake if at most a tenth of the squares is left
/// (of each kind of row over LargestError), and less than twice what the best one leaves.
///
/// Plates that touch two tables in one file are named first (FindTwoTables).
///
/// Then up to three rows (at most one in ten) that contradict all others are named, because they
/// would spoil all that is tried on all rows.
///
/// If no mistake explains all rows, those of single files are examined if another file is sound,
/// and those of a file from some row on if the rows before are.
///
/// Returns sentences, the best first: "j4: the sign of its positions is reversed (--accept sign:j4
/// corrects it)". Call it for a recording that no robot explains: a clean one has no mistakes, but
/// the search makes some hundred fits.
std::vector<std::string> FindObservedMistakes(const ObservedRobot& model,
                                              const Observations& observations);

}  // namespace elastocal
