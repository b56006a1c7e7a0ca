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

/// The project as a file sees it that has these columns: joints of linkages have the names of their
/// motors where the file has columns of these, and the joints' own columns are passed over. A file
/// without any motor of a linkage holds the positions of its joints, which the robot's controller
/// has from the nominal rods. Throws InputError naming `source` where some motors of a linkage have
/// columns and others have none.
Project WithMotors(const Project& project, const std::vector<std::string>& columns,
                   const std::string& source);

/// " (or those of its motors 'a', 'b')" for a joint of a linkage, about columns that are missing;
/// empty for others.
std::string OrItsMotors(const RobotTree& tree, int joint);

/// Replaces positions of motors [rad; actuators m] by those of the joints: `columns[i]` is that of
/// the linkage's motor i in `table`, one posture a row. `by_motors`, where given, gets the
/// derivatives of each row (Closure). Returns the first row in which the loops do not close, which
/// stays as it is, or -1.
Eigen::Index MotorsToJoints(const RobotTree& tree, const Linkage& linkage,
                            const std::vector<int>& columns, Eigen::MatrixXd& table,
                            std::vector<Eigen::MatrixXd>* by_motors = nullptr);

/// "motor 'a' at 3 rad and motor 'b' at 0.1 rad: the rods of linkage 'l' do not reach there ...",
/// about the row `failed` of positions of the linkage's motors, and which sign, exchange or unit
/// would let the loops close in it and in the others (of many, a hundred evenly spread).
std::string CannotClose(const RobotTree& tree, const Linkage& linkage,
                        const Eigen::MatrixXd& motors, Eigen::Index failed);

/// The log of motors as that of the joints; torques by the virtual work: those of the joints have
/// the power of those of the motors. A joint has no torque where one of its motors has none. Throws
/// InputError where loops do not close.
void MotorsToJoints(const RobotTree& tree, JointLog& log);

/// The other way, for files that are written. Throws InputError where a rod does not reach.
JointLog JointsToMotors(const RobotTree& tree, JointLog log);

/// The same of postures `q`, one a row, of which the joints `absent` are not written. Returns the
/// tree with motors in the place of joints.
RobotTree JointsToMotors(const RobotTree& tree, const std::vector<std::string>& absent,
                         Eigen::MatrixXd& q);

}  // namespace elastocal
