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

/// Knowledge of a controller about its robot.
enum class DeployAs {
  kNominal,     ///< the URDF: joints follow the plan
  kUrdf,        ///< the calibrated URDF: its rigid kinematics reach the planned poses
  kCompensated  ///< geometry and elasticity: the plan corrected by `compensate`
};

/// "nominal", "urdf", "compensated".
const char* DeployName(DeployAs as);

/// A motion as executed by a robot. The simulator measures poses in the frame of the first foot
/// that stands in the plan; they are compared with those of the nominal robot in the plan.
struct Execution {
  DeployAs as = DeployAs::kNominal;
  bool stabilised = false;
  /// Reason why the motion cannot be corrected for this robot within its limits, and was not
  /// played; empty where it was.
  std::string refused = {};
  StandingRun run;
  PlaceError hands;  ///< ends of limbs that are arms (IsArm) and no legs
  PlaceError swinging_feet;
  PlaceError landing;  ///< swinging foot, 50 ms before the plan sets it down
  PlaceError waist;    ///< the root link
  PlaceError centre_of_mass;
  /// Error of the controller's estimate of the root link on the first foot, by encoders and its
  /// knowledge of the robot, against the simulator: on one foot, and on several.
  PlaceError root_on_one_foot, root_on_several_feet;
  /// Pictures of the first run of each robot (the stabilised one, if there is one): five a second,
  /// fewer where they would be more than 2000.
  Playback playback = {};
};

/// Settings of PlayExecutions.
struct DeployOptions {
  std::vector<DeployAs> as = {DeployAs::kNominal, DeployAs::kUrdf, DeployAs::kCompensated};
  std::vector<bool> stabilised = {true, false};  ///< runs of each robot: with a stabiliser, without
  TruthOptions truth = {};  ///< errors of the robot: those of the robot that was calibrated
  PhysicsOptions physics = {};
  /// Time at which the motion is cut off.
  double until_s = std::numeric_limits<double>::infinity();
  /// Model of the loads in the controller. (A lifted leg that swings fast deflects its hip by more
  /// than its weight does.)
  MotionLoads loads = MotionLoads::kPlanned;
  /// Robots that are simulated at the same time; the result does not depend on it.
  int threads = 2;
};

/// Plays a planned motion on one free-standing robot with errors, once for each kind of knowledge,
/// with and without a stabiliser as the options say. All controllers hold their commanded positions
/// against the load (their servos integrate) and compensate the lag of the servos by feed-forward.
/// Progress counts runs.
///
/// Throws InputError for a motion without time or support, with samples on no foot, or with fewer
/// than three samples until `until_s`, and for a calibration of another robot.
std::vector<Execution> PlayExecutions(const Project& project, const StoredCalibration& calibration,
                                      const JointMotion& motion, const DeployOptions& options,
                                      const Progress& progress = {});

/// The executions as JSON, with what the report's page needs to play the robots side by side.
/// `tree` is the nominal one. `calibration_fingerprint` is that of the calibration that the
/// controllers know.
std::string FormatExecutions(const RobotTree& tree, const std::string& calibration_fingerprint,
                             const std::vector<Execution>& executions);

}  // namespace elastocal
