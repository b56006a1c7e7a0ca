// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/project/project.hpp"
#include "elastocal/robot/error_model.hpp"
#include "elastocal/screening/log_check.hpp"

namespace elastocal {

/// A suspicion of any kind, with the corrected recording.
struct TriedCorrection {
  std::string name, what;  ///< an empty name: it has to be corrected at its source
  Recording corrected;
  std::vector<int> left_out = {};  ///< postures that `corrected` lacks, ascending
  /// It only leaves out postures and corrects none, so that anything wrong with them disappears.
  bool only_leaves_out = false;
};

/// Largest error that a robot with estimated errors leaves, m: 20 mm, or 0.8 % of RobotSize if that
/// is less.
double MostLeft(const RobotTree& tree);

ErrorModel NominalModel(const Project& project, const Recording& recording);

TriedCorrection Undone(const LogSuspicion& one, const RobotTree& tree, const Recording& recording);

/// Adds the correction to `tried`, unless rods would not close with it.
void AddUndone(const LogSuspicion& one, const RobotTree& tree, const Recording& recording,
               std::vector<TriedCorrection>& tried);

enum class SuspicionsOf { kAll, kNamed };

/// Suspicions by the nominal robot, each with the corrected recording; at most `most` of labels and
/// `most` of the log. kNamed leaves out those without a name, whose search takes longest.
std::vector<TriedCorrection> Suspicions(const Project& project, const ErrorModel& nominal,
                                        const Recording& recording, std::size_t most,
                                        SuspicionsOf which = SuspicionsOf::kAll);

}  // namespace elastocal
