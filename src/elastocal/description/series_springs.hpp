// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/calibration/sole_springs.hpp"
#include "elastocal/robot/legs.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Place of a spring between the root link and the child link of a joint, from the root outwards.
enum class SpringPlace {
  kLeg,       ///< a leg as a whole (eq. 6), before its first joint
  kRootLink,  ///< bending of the root link up to the joint
  kJoint,     ///< the joint itself, before its motor (eq. 5)
  kSole,      ///< the sole below a foot, after the motor of the leg's last joint
};

/// A spring in series with the motor of a joint. It deflects by its compliance times the load about
/// (along) its axis, which the joint's encoder does not measure.
struct SeriesSpring {
  int joint = 0;  ///< of the robot tree
  SpringPlace place = SpringPlace::kJoint;
  std::string name;  ///< of the parameter: "JOINT.compliance_x"
  bool slides = false;
  Eigen::Vector3d axis;     ///< unit vector; see SeriesSprings for the frame
  Eigen::Vector3d anchor;   ///< a point of the axis, m
  double compliance = 0.0;  ///< rad/(N.m), or m/N for a spring that slides; positive
  double unloaded = 0.0;    ///< position without load, rad or m
};

/// The springs of a calibration, those of one joint together, from the root outwards. Axes and
/// anchors of a joint's own springs are in the frame of its child link at position 0 as
/// `calibrated` (the calibrated URDF) has it; those of legs and of the root link are in the frame
/// of the root link.
///
/// Springs of a joint and of the root link are those of eq. 5, except that a rotation vector is
/// replaced by rotations about x, y and z one after the other; the difference is the product of two
/// deflections. Springs of a leg (eq. 6) have the axes of the foot, which turn against the root
/// link with the leg. Here these axes are fixed as they are when both are level: in a posture in
/// which they are inclined by an angle a, compliances are mixed by sin a. A leg without a first
/// joint of its own on the root link has no springs. Compliances of 0 are left out.
///
/// A leg's spring also bears the weight of the leg itself. The robot at run time counts that weight
/// by the foot's share of the robot's weight (ec_leg_load), because the geometry is that of a leg
/// that hangs when it is lifted. So a spring that slides is at its position 0 while the leg
/// hangs from a level root link, and its compliance is smaller by the leg's share of all masses. It
/// then deflects as at run time, whatever its foot bears. No such change of a spring that turns
/// suits every load, because the floor presses at another point than below the leg's centre of
/// mass. Its compliance is that of the calibration: it turns as at run time on one foot, and a
/// share 1 - s too far by the moment of the leg's own weight where the foot bears the share s.
std::vector<SeriesSpring> SeriesSprings(const CalibrationResult& calibration,
                                        const RobotTree& calibrated, const std::vector<Leg>& legs);

/// The springs below the feet that `soles` has: along the axis that is upright while the foot is
/// flat, in the frame of the child link of the leg's last joint. That link is then on the floor's
/// side of the spring, so that its own weight is no load.
std::vector<SeriesSpring> SpringsOfSoles(const std::vector<SoleSpring>& soles,
                                         const RobotTree& calibrated, const std::vector<Leg>& legs);

}  // namespace elastocal
