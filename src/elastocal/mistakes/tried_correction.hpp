// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/project/project.hpp"
#include "elastocal/robot/error_model.hpp"
#include "elastocal/screening/log_check.hpp"

namespace elastocal {

/// A suspicion of any kind.
struct TriedCorrection {
  std::string name, what;  ///< no name: it is to be mended where it comes from
  Recording corrected;
  std::vector<int> left_out = {};  ///< postures that `corrected` is without, ascending
  /// It takes postures out and corrects none: whatever is wrong with them is gone, too.
  bool only_leaves_out = false;
};

/// No robot whose errors are estimated leaves more, m.
double MostLeft(const RobotTree& tree);

ErrorModel NominalModel(const Project& project, const Recording& recording);

TriedCorrection Undone(const LogSuspicion& one, const RobotTree& tree, const Recording& recording);

/// Adds it; not where rods would not close without it.
void AddUndone(const LogSuspicion& one, const RobotTree& tree, const Recording& recording,
               std::vector<TriedCorrection>& tried);

enum class SuspicionsOf { kAll, kNamed };

/// What the nominal robot makes one suspect, with the recording that is left once it is undone; at
/// most so many of labels and of the log. kNamed: without those that have no name, whose search
/// takes longest.
std::vector<TriedCorrection> Suspicions(const Project& project, const ErrorModel& nominal,
                                        const Recording& recording, std::size_t most,
                                        SuspicionsOf which = SuspicionsOf::kAll);

}  // namespace elastocal
