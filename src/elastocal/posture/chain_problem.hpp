// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/identifiability/base_parameters.hpp"
#include "elastocal/posture/posture_problem.hpp"
#include "elastocal/robot/motion_setup.hpp"

namespace elastocal {

/// The feasible set of a chain (eq. 8-11), while everything that the chain does not move is at
/// rest.
FeasibleSet MakeFeasibleSet(const RobotTree& tree, const MotionSetup& motion,
                            const ChainSetup& chain);

/// Parameters that the chain's markers can determine while only the chain moves: those of its
/// joints, T0 and its markers (those of joints before the chain are held). They are found as by
/// FindBaseParameters, but over random postures within the joint limits of the chain. The
/// model's compliances are among them if gravity excites them.
BaseParameters FindChainParameters(const ErrorModel& model, const MotionSetup& motion,
                                   const ChainSetup& chain, IdentifiabilityOptions options);

/// The problem of a chain. `model` must be that of the chain's markers; model and set-up must
/// outlive the problem. With cameras, a marker counts if a line of sight to one of them misses all
/// spheres except those of the marker's own link.
PostureProblem MakeChainProblem(const ErrorModel& model, const std::vector<int>& base,
                                const MotionSetup& motion, const ChainSetup& chain,
                                Criterion criterion = Criterion::kO1);

/// The same set-up (box, floor and contacts) reflected for the chain on the other side, whose tip
/// `other_tip` is moved by `coordinates`. Each sphere is exchanged for the one that is its mirror
/// image at zero posture. If a sphere has none, the result is empty, and `reason` says so.
std::optional<ChainSetup> MirrorSetup(const RobotTree& tree, const MotionSetup& motion,
                                      const ChainSetup& chain, const std::string& other_name,
                                      int other_from, int other_tip, std::string* reason);

}  // namespace elastocal
