// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "elastocal/io/calibration_file.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/runtime/runtime_model.hpp"

namespace elastocal {

/// What of a calibration a robot model carries.
enum class RuntimeContent {
  kNominal,    ///< nothing: the URDF as it is
  kGeometry,   ///< the geometry, as a calibrated URDF has it: rigid
  kEverything  ///< geometry and elasticity of joints and legs
};

/// The calibrated robot for a controller (runtime/compensator.hpp). The ends of the limbs are the
/// tips of the project's chains. Feet are the tips of its legs, in the order of the chains, with
/// the centres of the project's soles. Throws InputError where the calibration is of another robot
/// (NominalFingerprint), and where it has parameters that the project's robot does not have.
RuntimeModel MakeRuntimeModel(const Project& project, const StoredCalibration& calibration,
                              RuntimeContent content = RuntimeContent::kEverything);

/// What a model without tips is worth, in words: no command can be corrected.
std::string NothingToCorrect();

/// The error model with the joints and legs that a calibration found elastic, for all markers of
/// the project, and the calibration's errors of joints and legs in its order.
struct StoredRobot {
  ErrorModel model;
  Eigen::VectorXd errors;
};
StoredRobot RestoreRobot(const Project& project, const StoredCalibration& calibration);

}  // namespace elastocal
