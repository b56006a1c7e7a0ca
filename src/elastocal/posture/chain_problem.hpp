#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/identifiability/base_parameters.hpp"
#include "elastocal/posture/posture_problem.hpp"
#include "elastocal/robot/motion_setup.hpp"

namespace elastocal {

/// The feasible set of a chain (eq. 8-11), all that it does not move being at rest.
FeasibleSet MakeFeasibleSet(const RobotTree& tree, const MotionSetup& motion,
                            const ChainSetup& chain);

/// Parameters that the chain's markers can determine while only the chain moves: those of its
/// joints, T0 and its markers (those of joints before the chain are held). By random postures
/// within the joint limits of the chain, and otherwise as FindBaseParameters; of the compliances
/// that the model has, those that gravity excites.
BaseParameters FindChainParameters(const ErrorModel& model, const MotionSetup& motion,
                                   const ChainSetup& chain, IdentifiabilityOptions options);

/// The chain's problem. `model`: of the chain's markers. Both must outlive it. With cameras, a
/// marker counts where a line of sight to one of them misses all spheres but those of its own link.
PostureProblem MakeChainProblem(const ErrorModel& model, const std::vector<int>& base,
                                const MotionSetup& motion, const ChainSetup& chain,
                                Criterion criterion = Criterion::kO1);

/// The same set-up reflected for the chain on the other side, `coordinates` being those that move
/// `other_tip`: box, floor and contacts, each sphere exchanged for the one that is its mirror image
/// at zero posture. Nothing, and why in `reason`, where a sphere has none.
std::optional<ChainSetup> MirrorSetup(const RobotTree& tree, const MotionSetup& motion,
                                      const ChainSetup& chain, const std::string& other_name,
                                      int other_from, int other_tip, std::string* reason);

}  // namespace elastocal
