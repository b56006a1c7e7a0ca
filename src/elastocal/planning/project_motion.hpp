// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "elastocal/io/posture_file.hpp"
#include "elastocal/motion/plan.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/robot/joint_motion.hpp"

namespace elastocal {

/// The project's robot, standing in its posture of rest, with what keeps its parts apart: the
/// contacts of all chains of the section `design`. Without soles its root link is held still.
/// Throws InputError where a chain of the section `design` stands on feet and there are no soles,
/// and where the robot cannot stand.
std::unique_ptr<StandingRobot> StandProjectRobot(const Project& project,
                                                 const MotionLimits& limits);

/// Pairs of spheres of all chains and of those on the other side, each once: those of
/// StandingRobot::clearances.
std::vector<SpherePair> AllContacts(const Project& project);

/// Names of these pairs, "LHAND and BELLY", and then of the tables of StandAtTables.
std::vector<std::string> ContactNames(const Project& project);

/// The sets of a posture file. Throws what FeetOf throws.
std::vector<PostureTour> PostureTours(const StandingRobot& robot,
                                      const std::vector<ChainPostures>& chains);

/// Links of soles, by sample, and times: what files hold.
JointMotion ToJointMotion(const StandingRobot& robot, const SampledMotion& motion);

/// "joint torque limit: leg_left_4_joint at 104 %" and the like.
std::string ReasonText(const Project& project, const LeftOut& left_out);

}  // namespace elastocal
