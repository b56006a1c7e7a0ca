// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// Mistakes in a posture table or its project that the nominal robot shows before anything is
/// estimated, in words with what corrects them; empty where it shows none, for trials, and for
/// fewer than eight postures. Each is undone, and is a mistake if a tenth or less is left of the
/// squares of PlacedMisfit. Tried are: the sign of each joint or motor, two of them exchanged,
/// labels exchanged, rows shifted (RecordingMistake); where none of these helps, couplings and
/// mimic joints of the opposite sign or that do not follow, and a root link that stands elsewhere
/// in each posture.
std::vector<std::string> FindPlainMistakes(const Project& project, const Recording& recording);

}  // namespace elastocal
