// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "elastocal/io/calibration_file.hpp"
#include "elastocal/math/progress.hpp"
#include "elastocal/planning/compensate_motion.hpp"
#include "elastocal/planning/place_error.hpp"
#include "elastocal/planning/playback.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/simulation/stand_through.hpp"

namespace elastocal {

/// What the controller of a robot knows of it.
enum class DeployAs {
  kNominal,     ///< the URDF as it was: joints follow the plan
  kUrdf,        ///< the calibrated URDF: joints put its rigid kinematics where the plan meant
  kCompensated  ///< geometry and elasticity: the plan as `compensate` corrects it
};

/// "nominal", "urdf", "compensated".
const char* DeployName(DeployAs as);

/// A motion as a robot executed it. Poses are measured by the simulator, in the frame of the first
/// foot that the plan has on the floor, and compared with those of the nominal robot in the plan.
struct Execution {
  DeployAs as = DeployAs::kNominal;
  bool stabilised = false;
  /// Why the motion cannot be corrected for this robot within its limits, and was not played; empty
  /// where it was.
  std::string refused = {};
  StandingRun run;
  PlaceError hands;  ///< ends of limbs that are no legs, and arms (IsArm)
  PlaceError swinging_feet;
  PlaceError landing;  ///< of a swinging foot 50 ms before the plan sets it down
  PlaceError waist;    ///< the root link
  PlaceError centre_of_mass;
  /// Where the controller has the root link on the first foot, by its encoders and what it knows,
  /// against the simulator: on one foot, and on several.
  PlaceError root_on_one_foot, root_on_several_feet;
  /// Of the first run of each robot, the stabilised one where there is one: five pictures a second,
  /// fewer where they would be more than 2000.
  Playback playback = {};
};

struct DeployOptions {
  std::vector<DeployAs> as = {DeployAs::kNominal, DeployAs::kUrdf, DeployAs::kCompensated};
  std::vector<bool> stabilised = {true, false};  ///< each robot with a stabiliser and without
  TruthOptions truth = {};  ///< the robot's errors: those of the robot that was calibrated
  PhysicsOptions physics = {};
  /// The motion is played to this time of its own.
  double until_s = std::numeric_limits<double>::infinity();
  /// What deflects the robot, as the controller knows it: a lifted leg that swings fast bends its
  /// hip by more than its weight does.
  MotionLoads loads = MotionLoads::kPlanned;
  int threads = 2;  ///< robots at a time; the result does not depend on it
};

/// Plays a planned motion on one robot with errors that stands free, once for each way to know it,
/// with and without a stabiliser where the options ask for both. All controllers hold the positions
/// that they command against the load (their servos integrate) and feed forward what their servos
/// lag behind. Progress counts runs.
///
/// Throws InputError for a motion without time or support, or with samples on no foot, or fewer
/// than three until `until_s`, and for a calibration of another robot.
std::vector<Execution> PlayExecutions(const Project& project, const StoredCalibration& calibration,
                                      const JointMotion& motion, const DeployOptions& options,
                                      const Progress& progress = {});

/// As JSON, with what the report's page needs to play the robots side by side. `tree`: the nominal
/// one. `calibration_fingerprint`: of the calibration that the controllers know.
std::string FormatExecutions(const RobotTree& tree, const std::string& calibration_fingerprint,
                             const std::vector<Execution>& executions);

}  // namespace elastocal
