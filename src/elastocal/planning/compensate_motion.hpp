// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/planning/expected_errors.hpp"
#include "elastocal/planning/planned_motion_file.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/robot/joint_motion.hpp"
#include "elastocal/runtime/compensator.hpp"

namespace elastocal {

/// The loads that deflect the robot in a planned motion.
enum class MotionLoads {
  kStatics,  ///< of each posture at rest
  kPlanned   ///< torques of the motion by inverse dynamics: for fast motion; it needs soles
};

/// The worst value over a motion, and where it occurs.
struct MotionExtreme {
  double value = 0.0;
  double time_s = 0.0;
  std::string where = {};  ///< a joint or a pair of parts
};

/// How far limits keep the end of a limb from its place in a motion: a distance, to which an angle
/// counts as its displacement at `arm_m`.
struct LeftAtLimb {
  std::string limb;  ///< a chain of the project
  MotionExtreme most;
  int samples = 0;  ///< in which it is more than kLeftOver_m
  /// Whether the limb has fewer than six joints and shares some with a limb of six or more, whose
  /// end has priority: the end of a head on a trunk that carries arms.
  bool yields = false;
  double arm_m = 0.3;  ///< a tenth where a limb has too few joints for place and attitude
};

inline constexpr double kLeftOver_m = 2e-4;

/// A planned motion with corrected joint positions, which bring hands, feet and waist of the
/// calibrated robot to where the plan meant them.
struct CompensatedMotion {
  std::vector<std::string> at_rest;  ///< joints that the motion leaves open
  PlannedMotion planned;             ///< zero-moment points and torques are those of the plan
  MotionExtreme correction;          ///< largest change of a joint, rad or m
  double residual_m = 0.0, residual_rad = 0.0;  ///< largest that is left at limbs that do not yield
  std::vector<LeftAtLimb> left;
  /// What the calibration does not know, which nothing above has in it (ExpectErrors): for whoever
  /// has the covariance to fill in.
  std::vector<ExpectedAtLimb> expected;
  MotionExtreme position;  ///< least distance to a joint's limit, rad or m
  MotionExtreme velocity;  ///< largest share of a joint's velocity limit
  /// Least distance of parts that can touch, of the calibrated robot with these positions, m; where
  /// there are any.
  MotionExtreme clearance;
  bool has_clearance = false;
  /// Least distance of the zero-moment point to the edge of the support (LeastAverageZmp), m, of
  /// the plan by the URDF, and of the calibrated robot with these positions and masses as
  /// described; where the motion says what stands when.
  MotionExtreme planned_zmp, zmp;
  bool has_zmp = false;
  /// Why the motion must not be played, a sentence each with what a user can do: limits that keep
  /// the end of a limb too far from its place, a joint beyond its limit or faster than it, parts
  /// that touch. Empty: it may be played.
  std::vector<std::string> broken;
  /// Of limits that keep a limb from its place by less than that, a sentence each.
  std::vector<std::string> warnings;
};

struct CompensateMotionOptions {
  MotionLoads loads = MotionLoads::kStatics;
  /// A motion is refused where more is left at the end of a limb that does not yield (LeftAtLimb).
  double most_left_m = 5e-3;
  /// A correction comes to the largest speed that it has beside the plan, a tenth of the joint's,
  /// in this time, s, and brakes in it (Compensator::EaseChanges); 0: as suddenly as the best one.
  double ease_s = 0.0;
};

/// Names of the coordinates of which the motion says nothing.
std::vector<std::string> OpenJoints(const Project& project, const JointMotion& motion);

/// The motion with joints that it leaves open as they are in the robot's posture of rest.
JointMotion WithOpenJointsAtRest(const Project& project, JointMotion motion);

/// Corrects every sample of a motion (Compensator::Command). No joint is faster than its limit for
/// it, or than the plan where that is faster. The motion has times or not; joints
/// that it leaves open are at rest. Its support may be left open: then all feet stand, or the root
/// link is held where there are none. Throws InputError for a support that is no foot of the model,
/// and for feet that are balls.
CompensatedMotion CompensateMotion(const Project& project, const RuntimeModel& model,
                                   const JointMotion& given,
                                   const CompensateMotionOptions& options = {});

/// As JSON: what `compensate --json` writes.
std::string MakeCompensationJson(const CompensatedMotion& result);

/// The feet of the model that are these links. Throws InputError for a link that is no foot.
StandingFeet FeetOfLinks(const Project& project, const RuntimeModel& model,
                         const std::vector<int>& links);

}  // namespace elastocal
