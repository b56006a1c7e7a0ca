// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "elastocal/runtime/core_poses.h"

namespace elastocal {

/// A calibrated robot as numbers: all that is needed at run time, and nothing else. SI units. It is
/// made from a project and a calibration (exports/runtime_robot.hpp) and kept in a file that a
/// controller reads without any other library.
///
/// Bodies are those of the URDF with fixed links joined: body 0 is the root link's, joint k moves
/// body k + 1. A coordinate is an entry of the position vector; joints that mimic another share its
/// coordinate.
struct RuntimeModel {
  std::string robot;        ///< name in the URDF
  std::string calibration;  ///< where the errors come from, for people
  std::string fingerprint;  ///< of the nominal robot (NominalFingerprint in io/fingerprint.hpp)
  std::vector<std::string> joint_names, coordinate_names, link_names, foot_names, tip_names;
  std::vector<ec_joint> nominal, calibrated;  ///< by joint
  std::vector<double> mass, moment;           ///< by body; three moments a body
  std::vector<int> leg_of_body;               ///< by body: index of a foot, or -1
  std::vector<ec_frame> links;
  std::vector<ec_foot> feet;  ///< at most 32
  std::vector<ec_tip> tips;
  std::vector<ec_shift> shifts;      ///< of positions of the calibrated joints
  std::vector<double> lower, upper;  ///< by coordinate
  /// In the root link's frame where that is held, m/s^2: how it hung or stood when the robot was
  /// calibrated. A robot on its feet takes the floor as level.
  std::vector<double> gravity = {0.0, 0.0, -9.81};
  std::vector<double> suspension = std::vector<double>(12);  ///< see ec_robot

  int joint_count() const { return static_cast<int>(calibrated.size()); }
  int coordinate_count() const { return static_cast<int>(lower.size()); }
  int foot_count() const { return static_cast<int>(feet.size()); }
};

/// The groups of coordinates that move common tips: what ec_robot needs beside RuntimeModel.
struct RuntimeBranches {
  std::vector<int> branch_of_coordinate, column_of_coordinate, branch_size;
};

/// Sets the branch of each tip (the joint at the root that carries it) and how its turns count, and
/// finds the coordinates of each branch.
RuntimeBranches FindBranches(RuntimeModel& model);

/// Whether a limb can place its end: one of fewer joints points (a neck), and so does one that
/// yields. After FindBranches.
bool IsArm(const ec_tip& tip);

/// Writes and reads the file of a model. Reading throws std::runtime_error naming the file, the
/// entry, what was found and what was expected; also for a model whose indices or sizes do not fit
/// together, or with numbers that are not finite (limits may be infinite).
void WriteRuntimeModel(const RuntimeModel& model, std::ostream& out);
RuntimeModel ReadRuntimeModel(std::istream& in, const std::string& source);
RuntimeModel ReadRuntimeModel(const std::filesystem::path& file);

}  // namespace elastocal
