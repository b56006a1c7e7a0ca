// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// The name that a column exported by PlotJuggler and other programs from a topic has in a joint
/// log: `/joint_states/JOINT/position` becomes JOINT_position; likewise `effort`, `torque` and
/// `velocity`. Other names stay as they are. Empty for a column of a topic's header, which is about
/// no joint.
std::string PlainColumnName(const std::string& name);

/// Makes a joint log of columns by name: JOINT, JOINT_position, JOINT_torque, JOINT_effort and
/// JOINT_velocity. Joints are in the order of their names, velocities are left out, and torques of
/// a joint without them are NaN. All columns must be as long as the time; their memory is released.
/// Throws InputError, whose message begins with `source`: a torque without positions, a position
/// twice, positions that are not finite, time that does not increase.
JointLog JoinColumns(const std::string& source, const std::vector<double>& time,
                     std::map<std::string, std::vector<double>>&& columns);

/// The same of positions and torques by the names of joints, which are taken as they are.
JointLog JoinJoints(const std::string& source, const std::vector<double>& time,
                    std::map<std::string, std::vector<double>>&& positions,
                    std::map<std::string, std::vector<double>>&& torques);

/// Throws InputError naming the sample where time does not increase or a position is not finite.
void CheckJointLog(const JointLog& log);

}  // namespace elastocal
