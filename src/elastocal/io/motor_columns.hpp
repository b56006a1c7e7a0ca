// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/trial.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// Tables and logs of a robot with linkages hold the columns of the motors. Everywhere else the
/// joints are where the nominal rods put them for these (see Linkage).

/// The project for reading a file with these columns. If the file has columns of a linkage's
/// motors, the joints of the linkage get the names of their motors, and the joints' own columns are
/// passed over. A file without any motor of a linkage holds the positions of its joints, which the
/// robot's controller computes by the nominal rods. Throws InputError naming `source` if only some
/// motors of a linkage have columns.
Project WithMotors(const Project& project, const std::vector<std::string>& columns,
                   const std::string& source);

/// End of a message about missing columns of a joint of a linkage: " (or those of its motors 'a',
/// 'b')"; empty for other joints.
std::string OrItsMotors(const RobotTree& tree, int joint);

/// Replaces positions of motors [rad; actuators m] by those of the joints: `columns[i]` is that of
/// the linkage's motor i in `table`, one posture a row. `by_motors`, where given, gets the
/// derivatives of each row (Closure). Returns the first row in which the loops do not close, which
/// stays as it is, or -1.
Eigen::Index MotorsToJoints(const RobotTree& tree, const Linkage& linkage,
                            const std::vector<int>& columns, Eigen::MatrixXd& table,
                            std::vector<Eigen::MatrixXd>* by_motors = nullptr);

/// A message about row `failed` of positions of a linkage's motors, in which the loops do not
/// close: "motor 'a' at 3 rad and motor 'b' at 0.1 rad: the rods of linkage 'l' do not reach there
/// ...". It names the reversed sign, exchange or unit with which the loops would close in this row
/// and in up to about a hundred others, evenly spread.
std::string CannotClose(const RobotTree& tree, const Linkage& linkage,
                        const Eigen::MatrixXd& motors, Eigen::Index failed);

/// Replaces motors in a log by the joints that they move. Torques follow from virtual work: those
/// of the joints have the same power as those of the motors. A joint has no torque (NaN) if a motor
/// of its linkage has none. Throws InputError if loops do not close.
void MotorsToJoints(const RobotTree& tree, JointLog& log);

/// Inverse of MotorsToJoints, for files that are written. Throws InputError if a rod does not
/// reach.
JointLog JointsToMotors(const RobotTree& tree, JointLog log);

/// The same for postures `q`, one in each row; the joints `absent` are not written. Returns the
/// tree with motors in the place of joints.
RobotTree JointsToMotors(const RobotTree& tree, const std::vector<std::string>& absent,
                         Eigen::MatrixXd& q);

}  // namespace elastocal
