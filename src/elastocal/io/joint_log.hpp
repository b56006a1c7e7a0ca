// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "elastocal/measurement/trial.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// Reads a log of joint positions and torques (docs/formats.md), a CSV with a header row and these
/// columns:
/// - time in s: `t`, `time` or the name that the project gives; or time in the unit at the end of
///   its name (`time_ns`) or in `time_unit`;
/// - positions of each joint, `JOINT` or `JOINT_position`, in rad or m, where JOINT is the joint's
///   name or its column in the project;
/// - torques of joints with a sensor, `JOINT_torque` or `JOINT_effort`, in N.m or N;
/// - for each force-torque sensor of the project none or all of `NAME_fx` to `NAME_tz`, in N and
///   N.m.
/// Velocities, mimic joints and columns that the project ignores are passed over. A joint without a
/// torque column, or with one that is empty or NaN in all rows, has NaN torques.
///
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
