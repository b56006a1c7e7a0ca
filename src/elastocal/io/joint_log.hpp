// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "elastocal/measurement/trial.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// Reads a log of joint positions and torques (docs/formats.md): CSV with a header row; a column of
/// the time in s, `t` or `time` or as the project names it, or
/// in the unit at the end of its name (`time_ns`) or in `time_unit`; for each joint `JOINT` or
/// `JOINT_position` in rad or m and, where it has a sensor, `JOINT_torque` or `JOINT_effort` in N.m
/// or N, JOINT being the joint's name or its column in the project; for each force-torque sensor of
/// the project none or six, `NAME_fx` to `NAME_tz`, in N and N.m. Velocities, mimic joints and
/// what the project ignores are passed over. A joint without a torque column, or with one that is
/// empty or NaN from the first to the last row, has NaN torques.
/// Throws InputError naming file, line and column: unknown columns (with the nearest known one),
/// text or NaN where a number belongs, time that does not increase, no rows, more than a million,
/// positions that look like degrees.
JointLog ReadJointLog(const std::filesystem::path& file, const Project& project,
                      const std::string& time_unit = {});

/// The same from a stream; `source` names it in messages.
JointLog ReadJointLog(std::istream& stream, const std::string& source, const Project& project,
                      const std::string& time_unit = {});

/// Writes such a table, with a torque column for each joint that has a torque: `t`, JOINT, ...,
/// JOINT_torque, ..., and then those of force-torque sensors. All digits are kept.
void WriteJointLog(const std::filesystem::path& file, const JointLog& log);

/// The text of such a table.
std::string FormatJointLog(const JointLog& log);

}  // namespace elastocal
