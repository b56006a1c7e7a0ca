// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/files/output_set.hpp"
#include "elastocal/io/posture_file.hpp"
#include "elastocal/math/progress.hpp"
#include "elastocal/motion/plan.hpp"
#include "elastocal/motion/validation_tours.hpp"
#include "elastocal/planning/planned_motion_file.hpp"
#include "elastocal/planning/touch_motion.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/simulation/stand_through.hpp"

namespace elastocal {

/// Settings of PlanMotion.
struct MotionPlanOptions {
  /// With plan.balanced = false the motion may exceed limits; its effects can then be studied.
  PlanOptions plan = {};
  MotionLimits limits = {};  ///< without the share of torques, which is the next member
  std::optional<double> torque_share = {};  ///< default: MotionSetup::motion_effort_share
  int threads = 2;  ///< chains that are planned at the same time; the result does not depend on it
  ValidationOptions validation = {};  ///< for PlanValidationMotion
  ApproachOptions approach = {};  ///< for hands that approach tables, in projects with `contact`
};

/// The worst value of a quantity over a whole motion with its limit, as text.
struct LimitUse {
  std::string what;  ///< "torque, % of limit"
  std::string worst,
      limit;            ///< in the unit that `what` names; `limit` is empty where there is none
  double time_s = 0.0;  ///< time of the worst value
  std::string where;    ///< joint, pair of parts or foot; empty for the whole robot
  bool broken = false;

  /// Text such as "torque, % of limit: 104 at 12.31 s (leg_left_4_joint), the limit is 90".
  std::string Describe() const;
};

/// A motion of the whole robot through sets of postures, one for each chain.
struct MotionPlan {
  std::vector<PostureTour> sets;     ///< the sets to be visited
  std::vector<PlannedTour> planned;  ///< parts of the motion in turn, one for each set
  PlannedMotion whole;
  double rate_hz = 100.0;
  MotionMargins margins;         ///< margins of the whole motion, computed from its samples
  std::vector<LimitUse> limits;  ///< worst values with their limits
  double seconds = 0.0;          ///< duration of the planning

  /// Sets of which no posture can be held and reached. With one of these there is no motion.
  std::vector<std::string> impossible;
  /// Those of `limits` that the motion exceeds. Empty unless the options ask for the impossible, or
  /// the motion is not balanced. A motion that exceeds limits should not be played.
  std::vector<LimitUse> broken() const;
  /// Postures that each set leaves out, with the reason, a sentence each.
  std::vector<std::string> left_out;
  /// Joints that leave the range of the project (design.range_deg, limit_margin), a sentence each:
  /// postures keep it, but the motion has to balance.
  std::vector<std::string> beyond_ranges;
};

/// Plans the motion through calibration postures (paper, section 3.6): their order, ways that avoid
/// collisions of the robot's parts, and balance on one foot or two with changes between. The same
/// input gives the same motion. Progress counts chains.
///
/// Without soles in the project, the root link is held still and nothing is balanced.
///
/// In a project with `contact` the robot stands on its feet as stated there, the postures are held
/// exactly, and each touch is reached from above its table (StandAtTables, TouchTours).
///
/// Throws InputError for shares outside (0, 1] in the options, for a chain that stands on something
/// that is no sole, and for a robot that cannot stand.
MotionPlan PlanMotion(const Project& project, const std::vector<ChainPostures>& postures,
                      const MotionPlanOptions& options, const Progress& progress = {});

/// As PlanMotion, for a validation motion of all chains of the project's section `design` and their
/// mirror images. The seed draws its postures.
MotionPlan PlanValidationMotion(const Project& project, ValidationKind kind, std::uint64_t seed,
                                const MotionPlanOptions& options, const Progress& progress = {});

/// Names of the sets that PlanValidationMotion plans.
std::vector<std::string> ValidationChains(const Project& project);

/// Settings of TryMotion.
struct MotionTrialOptions {
  int robots = 1;
  std::uint64_t seed = 1;  ///< seed of the first robot; the next ones have the following numbers
  double leg_errors =
      TruthOptions{}.leg_geometry_scale;  ///< factor on their legs' geometric errors
  double floor_friction = 0.5;
  /// false: the robots follow the motion without feedback from feet and inertial unit
  bool stabilised = true;
  /// Robots that are simulated at the same time; the result does not depend on it.
  int threads = 2;
};

/// The run of one robot through a motion.
struct MotionTrial {
  std::uint64_t seed = 1;
  StandingRun run;
};

/// Adjusts a plan for a robot with narrower limits (LeaveRoom): distances to the end of a joint's
/// range, and the required ones, are then counted to the joint's own limit.
void CountToOwnLimits(const Project& own, const Project& narrow, const MotionPlanOptions& options,
                      MotionPlan& plan);

/// Throws InputError where robots are to play a motion of a project without soles. Call it before
/// the motion is planned, which takes long.
void CheckTries(const Project& project, const MotionTrialOptions& options);

/// Plays a motion on free-standing robots with errors (MuJoCo). Progress counts robots. Throws as
/// CheckTries does.
std::vector<MotionTrial> TryMotion(const Project& project, const JointMotion& motion,
                                   const MotionTrialOptions& options,
                                   const Progress& progress = {});

/// Files written by `plan`: the motion and, for `motion.csv`, motion_margins.json beside it. If
/// requested, also the motion as a ROS trajectory, and in a folder a motion of each chain,
/// CHAIN_motion.csv, which simulate plays as a trial.
struct MotionFiles {
  std::filesystem::path motion, margins;
  std::filesystem::path trajectory = {};  ///< empty: none
  RosVersion ros = RosVersion::kRos2;     ///< version of ROS for the trajectory's stamps
  std::vector<std::filesystem::path> chains = {};

  explicit MotionFiles(const std::filesystem::path& output);

  /// Adds a file for each chain. Throws InputError where a file with that name exists that is no
  /// planned motion, and so is not replaced.
  void AddChains(const std::filesystem::path& folder, const std::vector<std::string>& names);

  /// Declares the files in the set, with what such files are recognised by: a motion by the header
  /// that `plan` writes, or as a table of the robot that `compensate` wrote (IsMotionTable).
  void Declare(const RobotTree& tree, OutputSet& outputs) const;
};

/// Sets the contents of these files, which must be declared.
void SetMotionFiles(const MotionFiles& files, const Project& project, const MotionPlan& plan,
                    const std::vector<MotionTrial>& trials, OutputSet& outputs);

/// The plan as JSON: times, postures visited and left out, margins, and the runs of the robots that
/// tried it.
std::string FormatMotionSummary(const Project& project, const MotionPlan& plan,
                                const std::vector<MotionTrial>& trials);

}  // namespace elastocal
