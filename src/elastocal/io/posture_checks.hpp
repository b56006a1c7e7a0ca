// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Checks that a recording is plausible. Throws InputError for
/// - two markers with identical numbers;
/// - positions that are not in metres: a marker ranges over more than three times the robot's size
///   though the root is held, or is that far from another one in a posture (the message names the
///   units that fit);
/// - joints that look like degrees (beyond two turns; CheckUnits) or millimetres (20 times their
/// limit);
/// - times that are not in seconds: in more than half of the steps, a joint would move faster than
///   20 rad/s (m/s) and five times its limit;
/// - two or more postures that are all the same.
void CheckPlausible(const Recording& recording, const RobotTree& tree);

/// Throws InputError for degrees or millimetres in the recorded positions of one joint, none of
/// them NaN. `place(i)` is the beginning of a message about the i-th position.
void CheckUnits(const Joint& joint, const Eigen::Ref<const Eigen::VectorXd>& positions,
                const std::function<std::string(Eigen::Index)>& place);

/// The same of all joints of a log or table; column k of `positions` is of joints[k]. Wheels and
/// wrists without limits may have turned many times: they are not taken for degrees where joints
/// with limits move within these, so that the positions are in radians.
void CheckUnits(const std::vector<const Joint*>& joints, const Eigen::MatrixXd& positions,
                const std::function<std::string(Eigen::Index)>& place);

/// Whether a position is beyond the joint's limits by more than a degree or 5 mm.
bool BeyondLimits(const Joint& joint, double position);

/// One sentence for each recorded joint that is beyond its limits in this sense, naming the
/// worst line and how many there are.
std::vector<std::string> LimitWarnings(const Recording& recording, const RobotTree& tree);

/// A sentence naming the lines that repeat the joint and marker positions of lines above them;
/// empty if there are none. The recording must have lines.
std::string RepetitionWarning(const Recording& recording);

}  // namespace elastocal
