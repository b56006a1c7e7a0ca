// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "elastocal/planning/expected_errors.hpp"
#include "elastocal/planning/left_at_limbs.hpp"
#include "elastocal/planning/planned_motion_file.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/robot/joint_motion.hpp"
#include "elastocal/runtime/compensator.hpp"

namespace elastocal {

/// Model of the loads that deflect the robot in a planned motion.
enum class MotionLoads {
  kStatics,  ///< loads of each posture at rest
  kPlanned   ///< torques of the motion by inverse dynamics, for fast motion; needs soles
};

/// A planned motion with corrected joint positions, which bring hands, feet and waist of the
/// calibrated robot to their planned poses.
struct CompensatedMotion {
  std::vector<std::string> at_rest;  ///< joints that the motion does not contain
  PlannedMotion planned;             ///< zero-moment points and torques are those of the plan
  MotionExtreme correction;          ///< largest change of a joint, rad or m
  double residual_m = 0.0, residual_rad = 0.0;  ///< largest deviation at limbs that do not yield
  std::vector<LeftAtLimb> left;
  /// Expected errors because the calibration does not know the geometry better (ExpectErrors); none
  /// of the values above contains them. To be filled in by a caller that has the covariance.
  std::vector<ExpectedAtLimb> expected;
  MotionExtreme position;  ///< least distance to a joint's limit, rad or m
  MotionExtreme velocity;  ///< largest share of a joint's velocity limit
  /// Least distance, m, of parts that can touch, for the calibrated robot at these positions; valid
  /// if `has_clearance`.
  MotionExtreme clearance;
  bool has_clearance = false;
  /// Least distance of the zero-moment point to the edge of the support (LeastAverageZmp), m: of
  /// the plan by the URDF, and of the calibrated robot at these positions with masses as described.
  /// Valid if `has_zmp`: the motion must say which feet stand.
  MotionExtreme planned_zmp, zmp;
  bool has_zmp = false;
  /// Reasons why the motion must not be played, a sentence each with what the user can do: limits
  /// that keep the end of a limb too far from its place, a joint beyond its limit or too fast,
  /// parts that touch. Empty: it may be played.
  std::vector<std::string> broken;
  /// Warnings where limits keep a limb from its place by less than that, a sentence each.
  std::vector<std::string> warnings;
};

/// Settings of CompensateMotion.
struct CompensateMotionOptions {
  MotionLoads loads = MotionLoads::kStatics;
  /// A motion is refused if the deviation at the end of a limb that does not yield (LeftAtLimb)
  /// exceeds `most_left_m`, or its angle `most_turned_rad` where the place comes first.
  double most_left_m = 5e-3;
  double most_turned_rad = 3.0 * M_PI / 180.0;
  /// Time in which a correction reaches its largest speed relative to the plan (a tenth of the
  /// joint's), and in which it brakes, s (Compensator::EaseChanges). 0: without limit.
  double ease_s = 0.0;
  /// Limits of deflections and corrections; the low-pass filter of torques has no effect here.
  CompensatorOptions limits = {};
};

/// Names of the coordinates that the motion does not contain.
std::vector<std::string> OpenJoints(const Project& project, const JointMotion& motion);

/// The motion with the joints that it lacks at their positions in the robot's posture of rest.
JointMotion WithOpenJointsAtRest(const Project& project, JointMotion motion);

/// Corrects every sample of a motion (Compensator::Command). No joint moves faster than its limit,
/// or than the plan where that is faster. The motion may be without times. Joints that it lacks are
/// at rest. If it does not state the support, all feet stand, or the root link is held if there are
/// none. Throws InputError for a support that is no foot of the model, and for feet that are balls.
CompensatedMotion CompensateMotion(const Project& project, const RuntimeModel& model,
                                   const JointMotion& given,
                                   const CompensateMotionOptions& options = {});

/// The result as JSON, as written by `compensate --json`.
std::string MakeCompensationJson(const CompensatedMotion& result);

/// The feet of the model on these links. Throws InputError for a link that is no foot.
StandingFeet FeetOfLinks(const Project& project, const RuntimeModel& model,
                         const std::vector<int>& links);

}  // namespace elastocal
