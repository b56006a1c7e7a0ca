// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "elastocal/runtime/core_poses.h"

namespace elastocal {

/// A calibrated robot as numbers, in SI units: all that is needed at run time, and nothing else. It
/// is made from a project and a calibration (exports/runtime_robot.hpp) and stored in a file that a
/// controller reads without other libraries.
///
/// Bodies are those of the URDF with fixed links joined: body 0 is that of the root link, and joint
/// k moves body k + 1. A coordinate is an entry of the position vector; joints that mimic another
/// share its coordinate.
struct RuntimeModel {
  std::string robot;        ///< name in the URDF
  std::string calibration;  ///< origin of the errors, for the user
  /// Fingerprint of the nominal robot (NominalFingerprint in io/fingerprint.hpp)
  std::string fingerprint;
  std::vector<std::string> joint_names, coordinate_names, link_names, foot_names, tip_names;
  std::vector<ec_joint> nominal, calibrated;  ///< by joint
  std::vector<double> mass, moment;           ///< by body; three first moments for each body
  std::vector<int> leg_of_body;               ///< by body: index of the leg's foot, or -1
  std::vector<ec_frame> links;
  std::vector<ec_foot> feet;  ///< at most 32
  std::vector<ec_tip> tips;
  std::vector<ec_shift> shifts;      ///< displacements of the calibrated joints' positions
  std::vector<double> lower, upper;  ///< by coordinate
  /// Gravity in the root link's frame, if that is held, m/s^2: as the robot hung or stood when it
  /// was calibrated. For a robot on its feet, the floor counts as level.
  std::vector<double> gravity = {0.0, 0.0, -9.81};
  std::vector<double> suspension = std::vector<double>(12);  ///< see ec_robot

  int joint_count() const { return static_cast<int>(calibrated.size()); }
  int coordinate_count() const { return static_cast<int>(lower.size()); }
  int foot_count() const { return static_cast<int>(feet.size()); }
};

/// Groups of coordinates that move common tips, which ec_robot needs beside RuntimeModel.
struct RuntimeBranches {
  std::vector<int> branch_of_coordinate, column_of_coordinate, branch_size;
};

/// Sets the branch of each tip (the tips that share coordinates, directly or by others) and how the
/// angles of the tip count, and finds the coordinates of each branch.
RuntimeBranches FindBranches(RuntimeModel& model);

/// Whether a limb can place its end by itself: by four coordinates or more that move the end of no
/// other limb. A limb of fewer only points (a neck, also on a jointed trunk), and so does one that
/// yields. Call it after FindBranches.
bool IsArm(const RuntimeModel& model, std::size_t tip);

/// The displacement, mm, as which a degree of attitude counts at the end of a limb whose turns
/// count at `arm_m` (ec_tip::arm).
double DegreeAsMillimetres(double arm_m);

/// Write and read the file of a model. Reading throws std::runtime_error that names file, entry,
/// what was found and what was expected, also for a model whose indices or sizes do not fit
/// together, or with numbers that are not finite (limits may be infinite).
void WriteRuntimeModel(const RuntimeModel& model, std::ostream& out);
RuntimeModel ReadRuntimeModel(std::istream& in, const std::string& source);
RuntimeModel ReadRuntimeModel(const std::filesystem::path& file);

}  // namespace elastocal
