// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/io/calibration_file.hpp"
#include "elastocal/pipeline/calibrated_robot.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/robot/joint_motion.hpp"
#include "elastocal/validation/common_parameters.hpp"

namespace elastocal {

/// By how much the end of a limb, or the root link, will be beside its place on the real robot
/// because the calibration does not know its geometry better, root mean square over a motion: seen
/// from the foot that stands (the first of several), or from a root link that is held. What no
/// recording tells (the frame of a hand against its markers) is in it as its prior has it.
struct ExpectedAtLimb {
  std::string limb;       ///< a chain of the project, or the root link
  double position = 0.0;  ///< m
  double attitude = 0.0;  ///< rad
};

/// From the covariance of the calibration, of some postures of the motion. Springs aside, and what
/// a stabiliser or fast motion adds. Limbs of which the recording says nothing have no entry; no
/// entries where the covariance is not known.
std::vector<ExpectedAtLimb> ExpectErrors(const Project& project,
                                         const StoredCalibration& calibration,
                                         const CalibrationEstimate& estimate,
                                         const JointMotion& motion);

/// The same of a calibration in files, whose covariance is read. Throws InputError where the file
/// of the covariance cannot be used.
std::vector<ExpectedAtLimb> ExpectErrors(const CalibratedRobot& robot, const JointMotion& motion);

}  // namespace elastocal
