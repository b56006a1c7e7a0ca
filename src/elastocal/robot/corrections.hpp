// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/parameters.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Known function of a posture that a correction multiplies. Here q is a joint's position, m_z its
/// load, and effort the URDF's largest torque (force) of the joint:
enum class CorrectionShape {
  kSin,           ///< sin q: the encoder's disc is off centre
  kCos,           ///< cos q
  kSinTwice,      ///< sin 2q: the disc is an ellipse, or tilted
  kCosTwice,      ///< cos 2q
  kGear,          ///< q - centre: an error of the gear's ratio, or of a spindle's lead
  kCoupling,      ///< position of another joint - centre: tendons, differentials, ball screws with
                  ///< splines
  kBacklash,      ///< sign of the load, smooth where it is below a fiftieth of the effort
  kHysteresis,    ///< direction of the last motion: friction before the elastic part of a drive
  kStiffening,    ///< m_z |m_z| / effort^2: a spring whose stiffness depends on the load
  kSuspensionMx,  ///< moment of the weight about x of the root link, N.m
  kSuspensionMy,  ///< moment of the weight about y of the root link, N.m
  kHours,         ///< time - centre, h
  kMass,          ///< 1: mass of a body, at its nominal centre of mass
  kFirstMoment,   ///< 1: first moment of a body about its link's origin, along an axis of the link
  kGravityTilt,   ///< 1: rotation of gravity about an axis of the root link
};

/// What a correction acts on.
enum class CorrectionTarget {
  kJoint,  ///< a joint's position
  kRoot,   ///< pose of the root link
  kLoads,  ///< loads of the joints by statics, and thereby the deflections of elastic joints
  kMarker  ///< position of a marker in its link
};

/// An error of the robot that geometry and springs do not describe. Either a joint, the root link
/// or a marker is displaced by an unknown number times a known function of the posture, or the
/// unknown number changes what loads the joints (a mass, a first moment, the tilt of gravity).
struct Correction {
  /// Name of the parameter: JOINT.SHAPE, waist.SHAPE, LINK.mass, LINK.moment_AXIS,
  /// gravity.tilt_AXIS or marker.MARKER.creep_AXIS.
  std::string name;
  std::string cause;  ///< physical cause; several corrections may describe one cause
  CorrectionShape shape = CorrectionShape::kGear;
  int joint = -1;       ///< joint whose position is corrected; -1: none
  int axis = -1;        ///< displacement along (0-2) or rotation about (3-5) an axis of the root
                        ///< link; axis of a load (0-2); axis of the marker's link (0-2)
  int source = -1;      ///< kCoupling: the other joint; kMass, kFirstMoment: joint of the body
  double centre = 0.0;  ///< position (time) at which the function is zero, rad or m (h)
  ParameterUnit unit = ParameterUnit::kRadian;
  double typical = 1e-3;         ///< standard deviation of the prior, in the unit
  std::string marker_name = {};  ///< marker that is displaced; empty: none
  int marker = -1;               ///< its index in the error model; -1: it has no such marker
};

/// What a correction acts on, by its joint, marker and function.
CorrectionTarget TargetOf(const Correction& correction);

/// What the corrections in a posture depend on, besides joint positions and loads.
struct PostureHistory {
  /// Direction of the last motion of each coordinate of q, -1 or 1; 0 or empty: unknown.
  Eigen::VectorXd approach;
  double hours = 0.0;
  /// Moment of the weight of all links about the origin of the root link, in its axes, N.m.
  Eigen::Vector3d root_moment = Eigen::Vector3d::Zero();
};

/// The load by which a correction divides the load of its joint, N.m or N: a fiftieth of the effort
/// for backlash (below it, the sign of the load is smooth), the effort for stiffening. 0.05 if the
/// effort is unknown.
double LoadScale(const RobotTree& tree, const Correction& correction);

/// Values of the known functions in one posture, one for each correction. `load_z` is m_z of each
/// joint, N.m or N; empty: no loads.
Eigen::VectorXd EvaluateShapes(const RobotTree& tree, const std::vector<Correction>& corrections,
                               const Eigen::VectorXd& q, const Eigen::VectorXd& load_z,
                               const PostureHistory& history);

/// All corrections that a robot may have:
/// - of the root link: suspension;
/// - of loads: mass and first moments of every body with mass that a joint moves, and the tilt of
///   gravity;
/// - of every joint that is not a mimic joint: eccentricity (first harmonic) and ellipticity
///   (second harmonic) if it is revolute, gear, coupling with its neighbours (not between two
///   prismatic joints), backlash, hysteresis, and stiffening if it is revolute and its effort is
///   known;
/// - if the postures have times: drift of the root link, and creep of the markers `markers`.
/// `hours` is the mean time of the postures, h; none if they have no times.
std::vector<Correction> PossibleCorrections(const RobotTree& tree, std::optional<double> hours,
                                            const std::vector<std::string>& markers = {});

/// The corrections of `all` that belong to one of the causes.
std::vector<Correction> CorrectionsOf(const std::vector<Correction>& all,
                                      const std::vector<std::string>& causes);

/// The causes of corrections, each once, in their order.
std::vector<std::string> CausesOf(const std::vector<Correction>& corrections);

}  // namespace elastocal
