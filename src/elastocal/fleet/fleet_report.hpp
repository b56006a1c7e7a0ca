// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/fleet/family.hpp"
#include "elastocal/fleet/manifest.hpp"
#include "elastocal/fleet/task_queue.hpp"

namespace elastocal {

/// What came out of a task.
struct SessionOutcome {
  const FleetTask* task = nullptr;
  TaskEnd end;
  std::string status;  ///< of summary.json; "not done" where there is no result
  int postures = 0;
  /// Held-out errors (or on the fit, where nothing was held out), m; NaN: unknown.
  double uncalibrated, urdf, compensated;
};

/// The outcome of a batch: all its sessions, and what the robots have in common.
struct FleetReport {
  std::vector<SessionOutcome> sessions;  ///< in the order of the tasks
  FleetFamily family;                    ///< of the robot that most sessions are of
  int robots = 0;                        ///< in the family
  std::vector<std::string> notes;        ///< sessions that are not in it, and why
  CalibrationEstimate prior;             ///< no parameters: fewer than three robots
};

/// Reads the results of tasks that have ended. A calibration that is not to be deployed is no
/// member of the family. A result that cannot be read is a note, not an error.
FleetReport MakeFleetReport(const std::vector<FleetTask>& tasks, const std::vector<TaskEnd>& ends,
                            const std::filesystem::path& output, double level = 0.05);

/// The names of the files of a report in the folder of a batch: fleet.json, fleet.html,
/// sessions.csv, family.csv, prior/calibration.yaml and prior/covariance.csv.
std::vector<std::filesystem::path> FleetFileNames();

/// Their contents in that order; the prior's are empty where there is none, and so is the page
/// where the program was built without it.
std::vector<std::string> MakeFleetFiles(const FleetReport& report);

}  // namespace elastocal
