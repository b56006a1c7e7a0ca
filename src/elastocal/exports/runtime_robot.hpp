// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "elastocal/io/calibration_file.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/runtime/runtime_model.hpp"

namespace elastocal {

/// The part of a calibration that a robot model contains.
enum class RuntimeContent {
  kNominal,    ///< none: the URDF as it is
  kGeometry,   ///< the geometry, rigid, as in a calibrated URDF
  kEverything  ///< geometry and elasticity of joints and legs
};

/// The calibrated robot for a controller (runtime/compensator.hpp). The ends of limbs are the tips
/// of the project's chains. Feet are the tips of those legs that have a sole in the project or a
/// spring in the calibration, in the order of the chains, with the centres of the project's soles;
/// an arm that hangs down is no foot. Throws InputError for a calibration of another robot
/// (NominalFingerprint), for parameters that the project's robot does not have, and for a robot
/// whose soles are balls.
RuntimeModel MakeRuntimeModel(const Project& project, const StoredCalibration& calibration,
                              RuntimeContent content = RuntimeContent::kEverything);

/// Text that a model without tips can correct no command.
std::string NothingToCorrect();

/// Text for a robot whose trials held the root link in attitudes more than 3 degrees from their
/// mean, which is the one at run time; else empty.
std::string GravityThatDiffers(const StoredCalibration& calibration);

/// The error model with the joints and legs that a calibration found elastic and all markers of the
/// project, and the calibration's errors of joints and legs in the order of its parameters.
struct StoredRobot {
  ErrorModel model;
  Eigen::VectorXd errors;
};
StoredRobot RestoreRobot(const Project& project, const StoredCalibration& calibration);

}  // namespace elastocal
