// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/fleet/family.hpp"
#include "elastocal/fleet/manifest.hpp"
#include "elastocal/fleet/task_queue.hpp"

namespace elastocal {

/// Result of a task.
struct SessionOutcome {
  const FleetTask* task = nullptr;
  TaskEnd end;
  std::string status;  ///< status in summary.json; "not done" where there is no result
  int postures = 0;
  /// Held-out errors (or errors of the fit, where nothing was held out), m; NaN: unknown.
  double uncalibrated, urdf, compensated;
};

/// Result of a batch: all its sessions, and what the robots have in common.
struct FleetReport {
  std::vector<SessionOutcome> sessions;  ///< in the order of the tasks
  FleetFamily family;                    ///< family of the robot type with most sessions
  int robots = 0;                        ///< number of robots in the family
  std::vector<std::string> notes;        ///< sessions that are not in the family, with the reason
  /// Prior for the next robot; without parameters for fewer than three robots.
  CalibrationEstimate prior;
};

/// Reads the results of tasks that have ended. A calibration that must not be deployed is no member
/// of the family. A result that cannot be read gives a note, not an error.
FleetReport MakeFleetReport(const std::vector<FleetTask>& tasks, const std::vector<TaskEnd>& ends,
                            const std::filesystem::path& output, double level = 0.05);

/// Names of the files of a report in the folder of a batch: fleet.json, fleet.html, sessions.csv,
/// family.csv, prior/calibration.yaml and prior/covariance.csv.
std::vector<std::filesystem::path> FleetFileNames();

/// Contents of these files, in the same order. Those of the prior are empty where there is none,
/// and the page where the program was built without it.
std::vector<std::string> MakeFleetFiles(const FleetReport& report);

}  // namespace elastocal
