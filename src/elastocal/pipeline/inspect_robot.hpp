// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/identifiability/base_parameters.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// Settings of InspectRobot.
struct InspectionOptions {
  /// Name patterns of parameters held at nominal; empty: those of the project.
  std::optional<std::vector<std::string>> hold = {};
  ExternalPriority external = ExternalPriority::kFirst;
  std::optional<std::uint64_t> seed = {};  ///< default: the project's
};

/// Parameters of a chain that its own markers can identify.
struct ChainInspection {
  std::string name;  ///< name of the chain; "(all markers)" for the whole robot
  int joints = 0;    ///< number of joints that move its markers
  ErrorModel model;
  BaseParameters base;
  std::vector<int> lost;  ///< parameters of the model that are lost by special marker positions
};

struct RobotInspection {
  std::vector<JointPlacement> placements;  ///< constants of eq. 1, one entry a joint of the tree
  std::vector<ChainInspection> chains;     ///< chains with markers, then the whole robot
  double mass = 0.0;                       ///< kg
  std::vector<std::string> warnings;
};

/// Determines the robot's modified Denavit-Hartenberg constants (eq. 1), and which error parameters
/// markers can identify (section 2.1), for each chain and for the whole robot. Throws InputError
/// for a pattern of `hold` that matches no parameter.
RobotInspection InspectRobot(const Project& project, const InspectionOptions& options = {});

/// The inspection for programs (docs/formats.md), SI.
std::string MakeInspectionJson(const Project& project, const RobotInspection& inspection);

}  // namespace elastocal
