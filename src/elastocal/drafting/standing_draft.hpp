// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/drafting/draft.hpp"

namespace elastocal {

/// Chooses the posture of rest, and whether the robot balances in it as `plan` does, shifting its
/// weight from foot to foot and lifting each once; if not, why. Legs that do not reach far enough
/// are bent further than usual, and those whose ankles do not bend so far less.
void RestOnFeet(ProjectDraft& draft, const Semantics& semantics);

/// Sets how far joints above the legs, which carry them all, can move while all feet keep their
/// places on the floor: the legs' own joints have to move against them.
void NarrowWaist(ProjectDraft& draft);

/// The posture of rest and, of a robot that balances, those in which it stands on its feet with the
/// weight over all and over the fewest of them, and lifts each: its parts do not touch in them,
/// whatever the spheres that cover them do.
std::vector<Eigen::VectorXd> RestingPostures(const ProjectDraft& draft);

}  // namespace elastocal
