// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/drafting/draft.hpp"

namespace elastocal {

/// Chooses the posture of rest, and finds out whether the robot balances in it as `plan` requires:
/// it shifts its weight from foot to foot and lifts each once. If not, stores the reason. Legs that
/// do not reach far enough are bent further than usual, and legs whose ankles do not bend so far
/// are bent less.
void RestOnFeet(ProjectDraft& draft, const Semantics& semantics);

/// Whether any link of the robot has a mass.
bool HasMasses(const RobotTree& tree);

/// Sets the range of joints that carry all legs, within which all feet can keep their places on the
/// floor while the legs' own joints compensate.
void NarrowWaist(ProjectDraft& draft);

/// Postures of rest: the drafted one and, for a robot that balances, those in which it stands with
/// its weight over all and over the fewest feet and lifts each. The robot's parts do not touch in
/// them, even if their covering spheres do.
std::vector<Eigen::VectorXd> RestingPostures(const ProjectDraft& draft);

}  // namespace elastocal
