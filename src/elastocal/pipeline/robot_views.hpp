// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/project/project.hpp"
#include "elastocal/report/calibration_view.hpp"

namespace elastocal {

/// The project's robot for the 3-D view, with the STL files that its URDF names, of at most 2 MB
/// together, so that a report stays small. A mesh that exists but cannot be read is left out, and
/// `warnings` receives a sentence. The view refers to `project.tree`.
RobotView MakeRobotView(const Project& project, std::vector<std::string>& warnings);

/// The clusters of the project; each single marker is a cluster of its own.
std::vector<ClusterView> MakeClusterViews(const Project& project);

}  // namespace elastocal
