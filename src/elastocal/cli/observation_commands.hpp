// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/cli/commands.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/simulation/virtual_experiment.hpp"

namespace elastocal::cli {

/// Options of `design` for a project with contact or instruments.
struct DesignObservationsCommand {
  CommonOptions common;
  std::string output;      ///< path of the posture file
  int count = 0;           ///< number of postures altogether; 0: the usual number
  std::string after = {};  ///< path of an earlier calibration; empty: none
  double days = 1.0;
  bool changes = false;
  std::vector<std::string> joints = {};
};
int RunObservationDesign(const DesignObservationsCommand& command, const Project& project);

/// Options of `simulate` for such a project.
struct SimulateObservationsCommand {
  CommonOptions common;
  std::string output;    ///< path of the folder
  std::string postures;  ///< path of the posture file; empty: `count` random postures of each kind
  int count = 0;         ///< 0: the usual number
  bool force = false;    ///< replace recordings that were not simulated
  VirtualExperimentOptions experiment;
};
int RunObservationSimulation(const SimulateObservationsCommand& command, const Project& project);

}  // namespace elastocal::cli
