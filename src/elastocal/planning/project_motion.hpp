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

/// The project's robot, standing in its posture of rest, with the contacts of all chains of the
/// section `design`, which keep its parts apart. Without soles its root link is held still. Throws
/// InputError where a chain of the section `design` stands on feet although there are no soles, and
/// for a robot that cannot stand.
std::unique_ptr<StandingRobot> StandProjectRobot(const Project& project,
                                                 const MotionLimits& limits);

/// Pairs of spheres of all chains and their mirror images, each pair once, in the order of
/// StandingRobot::clearances.
std::vector<SpherePair> AllContacts(const Project& project);

/// Names of these pairs, "LHAND and BELLY", then of the tables of StandAtTables.
std::vector<std::string> ContactNames(const Project& project);

/// The sets of a posture file. Throws as FeetOf.
std::vector<PostureTour> PostureTours(const StandingRobot& robot,
                                      const std::vector<ChainPostures>& chains);

/// The motion as in files: times, and the links of the standing soles by sample.
JointMotion ToJointMotion(const StandingRobot& robot, const SampledMotion& motion);

/// Reason why a posture is left out, as text: "joint torque limit: leg_left_4_joint at 104 %".
std::string ReasonText(const Project& project, const LeftOut& left_out);

}  // namespace elastocal
