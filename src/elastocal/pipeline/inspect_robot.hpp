// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/identifiability/base_parameters.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

struct InspectionOptions {
  /// Name patterns of parameters held at nominal, instead of the project's; nothing: the project's.
  std::optional<std::vector<std::string>> hold = {};
  ExternalPriority external = ExternalPriority::kFirst;
  std::optional<std::uint64_t> seed = {};  ///< instead of the project's
};

/// What can be identified of a chain by its own markers.
struct ChainInspection {
  std::string name;  ///< of the chain; "(all markers)" for the whole robot
  int joints = 0;    ///< that move its markers
  ErrorModel model;
  BaseParameters base;
  std::vector<int> lost;  ///< parameters of the model lost by special marker positions
};

struct RobotInspection {
  std::vector<JointPlacement> placements;  ///< eq. 1, one a joint of the tree
  std::vector<ChainInspection> chains;     ///< those with markers, then the whole robot
  double mass = 0.0;                       ///< kg
  std::vector<std::string> warnings;
};

/// The robot's modified Denavit-Hartenberg constants (eq. 1), and which error parameters markers
/// can identify (section 2.1), chain by chain and altogether. Throws InputError for a pattern of
/// `hold` that matches no parameter.
RobotInspection InspectRobot(const Project& project, const InspectionOptions& options = {});

/// The inspection for programs (docs/formats.md), SI.
std::string MakeInspectionJson(const Project& project, const RobotInspection& inspection);

}  // namespace elastocal
