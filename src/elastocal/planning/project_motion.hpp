#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "elastocal/io/posture_file.hpp"
#include "elastocal/io/project.hpp"
#include "elastocal/motion/plan.hpp"
#include "elastocal/robot/joint_motion.hpp"

namespace elastocal {

/// The project's robot, standing in its posture of rest, with what keeps its parts apart: the
/// contacts of all chains of the section `design`. Throws InputError where the project has no
/// soles, or the robot cannot stand.
std::unique_ptr<StandingRobot> StandProjectRobot(const Project& project,
                                                 const MotionLimits& limits);

/// Names of the pairs of parts in StandingRobot::clearances: "LHAND and BELLY".
std::vector<std::string> ContactNames(const Project& project);

/// The sets of a posture file. Throws what FeetOf throws.
std::vector<PostureTour> PostureTours(const StandingRobot& robot,
                                      const std::vector<ChainPostures>& chains);

/// Those of a validation motion, `sine`, `random` or `repeatability`, of all chains of the section
/// `design` and of those on the other side.
std::vector<PostureTour> ProjectValidationTours(const Project& project, const StandingRobot& robot,
                                                const std::string& kind, std::uint64_t seed);

/// Links of soles, by sample, and times: what files hold.
JointMotion ToJointMotion(const StandingRobot& robot, const SampledMotion& motion);

/// "joint torque limit: leg_left_4_joint at 104 %" and the like.
std::string ReasonText(const Project& project, const LeftOut& left_out);

/// Table of the worst values of a motion and the limits.
std::string MarginTable(const Project& project, const MotionMargins& margins,
                        const MotionLimits& limits, double rate_hz);

}  // namespace elastocal
