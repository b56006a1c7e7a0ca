// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// The name of a column as a log of ours has it, of one that PlotJuggler and other programs export
/// from a topic: JOINT_position of `/joint_states/JOINT/position`, likewise `effort`, `torque` and
/// `velocity`. Other names stay. Empty: a topic's header, which holds nothing of a joint.
std::string PlainColumnName(const std::string& name);

/// Columns by name, as JOINT, JOINT_position, JOINT_torque, JOINT_effort and JOINT_velocity, made
/// into a log: in the order of their names, velocities left out, NaN where a joint has no torque.
/// All columns are as long as the time, and are used up. Throws InputError, whose message begins
/// with `source`: a torque without positions, a position twice, positions that are not finite, time
/// that does not increase.
JointLog JoinColumns(const std::string& source, const std::vector<double>& time,
                     std::map<std::string, std::vector<double>>&& columns);

/// Throws InputError naming the sample where time does not increase or a position is not finite.
void CheckJointLog(const JointLog& log);

}  // namespace elastocal
