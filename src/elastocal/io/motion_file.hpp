// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "elastocal/project/project.hpp"
#include "elastocal/robot/joint_motion.hpp"

namespace elastocal {

/// Reads a joint trajectory (docs/formats.md "Motion"): CSV with a header row; a column `time` [s],
/// a column a joint [rad or m] by its name or as the project has it, and perhaps a column
/// `support`. Columns `zmp_x`, `zmp_y` and `torque_JOINT` are passed over, and those of mimic
/// joints.
///
/// Throws InputError naming file, line and column: no time, no joint, unknown columns (with the
/// nearest known one), columns that come twice, text or NaN where a number belongs, time that does
/// not increase, fewer than two rows, degrees, positions beyond a joint's limits by more than a
/// degree (5 mm), joints faster than their limit, a support that is no tip of a chain.
JointMotion ReadMotion(const std::filesystem::path& file, const Project& project);

/// The same from a stream; `source` names it in messages.
JointMotion ReadMotion(std::istream& stream, const std::string& source, const Project& project);

/// Reads a list of postures: a table like a motion, but without time. A posture table can be read
/// as well; its columns of time and of the project's markers are passed over.
JointMotion ReadPostureList(const std::filesystem::path& file, const Project& project);
JointMotion ReadPostureList(std::istream& stream, const std::string& source,
                            const Project& project);

}  // namespace elastocal
