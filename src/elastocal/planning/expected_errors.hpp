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

/// Expected error of the end of a limb, or of the root link, because the calibration does not know
/// the geometry better: root mean square over a motion, seen from the foot that stands (the first
/// of several) or from a held root link. Directions that no recording determines (such as the frame
/// of a hand relative to its markers) enter with their prior.
struct ExpectedAtLimb {
  std::string limb;       ///< a chain of the project, or the root link
  double position = 0.0;  ///< m
  double attitude = 0.0;  ///< rad
};

/// Computes expected errors from the covariance of the calibration, over some postures of the
/// motion. Deflections by springs, and the effects of a stabiliser or of fast motion, are left out.
/// Limbs of which the recording says nothing have no entry. Empty where the covariance is unknown.
std::vector<ExpectedAtLimb> ExpectErrors(const Project& project,
                                         const StoredCalibration& calibration,
                                         const CalibrationEstimate& estimate,
                                         const JointMotion& motion);

/// As above, for a calibration in files, whose covariance is read. Throws InputError where the
/// covariance file cannot be used.
std::vector<ExpectedAtLimb> ExpectErrors(const CalibratedRobot& robot, const JointMotion& motion);

/// Whether errors are seen from a foot, in some posture at least, and not from the root link alone:
/// the motion has a foot stand, or leaves that open while the robot has soles.
bool IsSeenFromAFoot(const Project& project, const JointMotion& motion);

}  // namespace elastocal
