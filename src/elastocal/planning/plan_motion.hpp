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

struct MotionPlanOptions {
  /// plan.balanced = false gives a motion that may break the limits, to see what comes of it.
  PlanOptions plan = {};
  MotionLimits limits = {};  ///< but for the share of torques, which is the next member
  std::optional<double> torque_share = {};  ///< default: MotionSetup::motion_effort_share
  int threads = 2;  ///< chains planned at a time; the result does not depend on it
  ValidationOptions validation = {};  ///< of PlanValidationMotion
  ApproachOptions approach = {};      ///< of hands to tables, in projects with `contact`
};

/// The worst value of a quantity over a whole motion beside its limit, in words for people.
struct LimitUse {
  std::string what;  ///< "torque, % of limit"
  std::string worst,
      limit;            ///< in the unit that `what` names; `limit` is empty where there is none
  double time_s = 0.0;  ///< when the worst value occurs
  std::string where;    ///< joint, pair of parts or foot; empty where it is of the whole robot
  bool broken = false;

  /// "torque, % of limit: 104 at 12.31 s (leg_left_4_joint), the limit is 90".
  std::string Describe() const;
};

/// A motion of the whole robot through sets of postures, one set a chain.
struct MotionPlan {
  std::vector<PostureTour> sets;     ///< what was to be visited
  std::vector<PlannedTour> planned;  ///< one a set, the parts of the motion in turn
  PlannedMotion whole;
  double rate_hz = 100.0;
  MotionMargins margins;         ///< of the whole motion, from its samples alone
  std::vector<LimitUse> limits;  ///< the same beside the limits
  double seconds = 0.0;          ///< that the planning took

  /// Sets of which no posture can be kept and reached. With one of these there is no motion.
  std::vector<std::string> impossible;
  /// What of `limits` the motion breaks: nothing, unless the options ask for the impossible or the
  /// motion is not balanced. Such a motion should not be played.
  std::vector<LimitUse> broken() const;
  /// What each set leaves out and why, a sentence each.
  std::vector<std::string> left_out;
  /// Joints that leave the range that the project asks for (design.range_deg, limit_margin), a
  /// sentence each: postures keep it, but the motion has to balance.
  std::vector<std::string> beyond_ranges;
};

/// Plans the motion through calibration postures (paper, section 3.6): order, ways that avoid the
/// robot's own parts, balance on one foot or two with changes between. The same input gives the
/// same motion. Progress counts chains.
///
/// Without soles in the project, the root link is held still and nothing is balanced.
///
/// In a project with `contact` the robot stands on its feet as there, the postures are held as they
/// are, and each touch is reached from above its table (StandAtTables, TouchTours).
///
/// Throws InputError for shares outside (0, 1] in the options, for a chain
/// that stands on what is no sole, and where the robot cannot stand.
MotionPlan PlanMotion(const Project& project, const std::vector<ChainPostures>& postures,
                      const MotionPlanOptions& options, const Progress& progress = {});

/// The same for a validation motion of all chains of the project's section `design` and of those on
/// the other side. The seed draws its postures.
MotionPlan PlanValidationMotion(const Project& project, ValidationKind kind, std::uint64_t seed,
                                const MotionPlanOptions& options, const Progress& progress = {});

/// Names of the sets that PlanValidationMotion plans.
std::vector<std::string> ValidationChains(const Project& project);

struct MotionTrialOptions {
  int robots = 1;
  std::uint64_t seed = 1;  ///< of the first robot; the next ones have the numbers after it
  double leg_errors =
      TruthOptions{}.leg_geometry_scale;  ///< factor on their legs' geometric errors
  double floor_friction = 0.5;
  bool stabilised = true;  ///< false: they follow the motion whatever feet and inertial unit feel
  int threads = 2;         ///< robots at a time; the result does not depend on it
};

/// How one robot came through a motion.
struct MotionTrial {
  std::uint64_t seed = 1;
  StandingRun run;
};

/// Of a plan for a robot with nearer limits (LeaveRoom): the distance to the end of a joint's range
/// is counted to the joint's own limit, and so is what it has to be.
void CountToOwnLimits(const Project& own, const Project& narrow, const MotionPlanOptions& options,
                      MotionPlan& plan);

/// Plays a motion on robots with errors that stand free (MuJoCo). Progress counts robots. Throws
/// InputError for a project without soles.
std::vector<MotionTrial> TryMotion(const Project& project, const JointMotion& motion,
                                   const MotionTrialOptions& options,
                                   const Progress& progress = {});

/// What `plan` writes: the motion and, if that is `motion.csv`, motion_margins.json beside it.
/// Where they are wanted: the motion as a ROS trajectory, and in a folder a motion of each chain,
/// CHAIN_motion.csv, that simulate plays as a trial.
struct MotionFiles {
  std::filesystem::path motion, margins;
  std::filesystem::path trajectory = {};  ///< empty: none
  RosVersion ros = RosVersion::kRos2;     ///< of the trajectory's stamps
  std::vector<std::filesystem::path> chains = {};

  explicit MotionFiles(const std::filesystem::path& output);

  /// Adds a file for each chain. Throws InputError where a file of that name stands there that is
  /// no planned motion: it is not replaced.
  void AddChains(const std::filesystem::path& folder, const std::vector<std::string>& names);

  /// To the set, with how files of these kinds begin.
  void Declare(OutputSet& outputs) const;
};

/// Puts the contents of these files, which have been declared, into the set.
void SetMotionFiles(const MotionFiles& files, const Project& project, const MotionPlan& plan,
                    const std::vector<MotionTrial>& trials, OutputSet& outputs);

/// The plan for programs (JSON): times, postures visited and left out, margins, and how the robots
/// came through that tried it.
std::string FormatMotionSummary(const Project& project, const MotionPlan& plan,
                                const std::vector<MotionTrial>& trials);

}  // namespace elastocal
