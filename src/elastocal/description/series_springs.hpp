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

/// What gives way between the root link and the child link of a joint, from the root outwards.
enum class SpringPlace {
  kLeg,       ///< a leg as a whole (eq. 6), in front of its first joint
  kRootLink,  ///< the root link, as the joint sees it
  kJoint,     ///< the joint, in front of its motor (eq. 5)
  kSole,      ///< what is below a foot, behind the motor of the leg's last joint
};

/// A spring in series with the motor of a joint, whose encoder does not see how far it gives way:
/// its compliance times the load about (along) its axis.
struct SeriesSpring {
  int joint = 0;  ///< of the robot tree
  SpringPlace place = SpringPlace::kJoint;
  std::string name;  ///< of the parameter: "JOINT.compliance_x"
  bool slides = false;
  Eigen::Vector3d axis;     ///< unit vector; see SeriesSprings for the frame
  Eigen::Vector3d anchor;   ///< a point of the axis, m
  double compliance = 0.0;  ///< rad/(N.m), or of one that slides m/N; positive
  double unloaded = 0.0;    ///< its position without load, rad or m
};

/// The springs of a calibration: those of one joint together, from the root outwards. Axes and
/// anchors of a joint's own are in the frame of its child link at position 0 as `calibrated` (the
/// calibrated URDF) has it, those of legs and of the root link in the frame of the root link.
///
/// Those of a joint and of the root link are those of eq. 5, but for a turn by a vector, which is
/// taken as turns about x, y and z one after the other: the difference is the product of two
/// deflections. Those of a leg are in the axes of the foot, which turn against the root link with
/// the leg. Here they are where they are when both are level: in a posture in which they are
/// inclined by an angle a, compliances are mixed by sin a. A leg without a first joint of its own
/// on the root link has none. Compliances of 0 are left out.
///
/// Such a spring bears the leg's own weight as well, which the robot at run time counts by the
/// foot's share of the robot's (ec_leg_load): the geometry has a lifted leg as it hangs. So it is
/// unloaded where it is 0 while the leg hangs at `rest` (by coordinate), and its compliance is less
/// by the leg's share of all masses. Deflections are then those of run time, whatever a foot bears.
std::vector<SeriesSpring> SeriesSprings(const CalibrationResult& calibration,
                                        const RobotTree& calibrated, const std::vector<Leg>& legs,
                                        const Eigen::VectorXd& rest);

/// What gives way below the feet, of those that are told: along the axis that is upright while the
/// foot is flat, in the frame of the child link of the leg's last joint. That link is then on the
/// floor's side of the spring: its own weight is no load.
std::vector<SeriesSpring> SpringsOfSoles(const std::vector<SoleSpring>& soles,
                                         const RobotTree& calibrated, const std::vector<Leg>& legs);

}  // namespace elastocal
