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
/// load; its largest torque is the URDF's effort:
enum class CorrectionShape {
  kSin,           ///< sin q: the encoder's disc is off centre
  kCos,           ///< cos q
  kSinTwice,      ///< sin 2q: the disc is an ellipse, or tilted
  kCosTwice,      ///< cos 2q
  kGear,          ///< q - centre: an error of the gear's ratio, or of a spindle's lead
  kCoupling,      ///< position of another joint - centre: tendons, differentials, ball screws with
                  ///< splines
  kBacklash,      ///< sign of the load, smooth where it is below a fiftieth of the effort
  kHysteresis,    ///< sign of the last motion: friction before the elastic part of a drive
  kStiffening,    ///< m_z |m_z| / effort^2: a spring whose stiffness depends on the load
  kSuspensionMx,  ///< moment of the weight about x of the root link, N.m
  kSuspensionMy,  ///< ... about y
  kHours,         ///< time - centre, h
  kMass,          ///< 1: mass of a body, at its nominal centre of mass
  kFirstMoment,   ///< 1: first moment of a body about the origin of its link, along an axis of that
  kGravityTilt,   ///< 1: rotation of gravity about an axis of the root link
};

/// What a correction acts on.
enum class CorrectionTarget {
  kJoint,  ///< a joint's position
  kRoot,   ///< pose of the root link
  kLoads,  ///< what the joints carry by statics, and through their compliances all beyond them
  kMarker  ///< position of a marker in its link
};

/// An error of the robot that geometry and springs do not describe: a displacement of a joint, of
/// the root link or of a marker, by an unknown number times a known function of the posture; or an
/// unknown number in what loads the joints.
struct Correction {
  /// Of the parameter: JOINT.SHAPE, waist.SHAPE, LINK.mass, LINK.moment_AXIS, gravity.tilt_AXIS,
  /// marker.MARKER.creep_AXIS.
  std::string name;
  std::string cause;  ///< the physical cause that it belongs to; several corrections may be one
  CorrectionShape shape = CorrectionShape::kGear;
  int joint = -1;       ///< whose position is corrected; -1: none
  int axis = -1;        ///< of the root link: displacement along (0-2) or rotation about (3-5) it;
                        ///< of a load: 0-2; of a marker: that of its link, 0-2
  int source = -1;      ///< joint whose position counts (kCoupling), that moves the body (kMass)
  double centre = 0.0;  ///< position (time) at which the function is zero, rad or m (h)
  ParameterUnit unit = ParameterUnit::kRadian;
  double typical = 1e-3;         ///< standard deviation of the prior, in the unit
  std::string marker_name = {};  ///< that is displaced; empty: none
  int marker = -1;               ///< the same, of the error model; -1: it has no such marker
};

CorrectionTarget TargetOf(const Correction& correction);

/// What a posture's corrections depend on beside joint positions and loads.
struct PostureHistory {
  /// By coordinate of q: direction of its last motion, -1 or 1; 0 or empty: unknown.
  Eigen::VectorXd approach;
  double hours = 0.0;
  /// Of the weight of all links about the origin of the root link, in its axes, N.m.
  Eigen::Vector3d root_moment = Eigen::Vector3d::Zero();
};

/// The load against which that of a joint counts: of backlash, below which its sign is smooth; of
/// stiffening, the effort. N.m or N.
double LoadScale(const RobotTree& tree, const Correction& correction);

/// The functions at one posture, one for each correction. `load_z`: m_z by joint, N.m or N.
Eigen::VectorXd EvaluateShapes(const RobotTree& tree, const std::vector<Correction>& corrections,
                               const Eigen::VectorXd& q, const Eigen::VectorXd& load_z,
                               const PostureHistory& history);

/// All corrections that a robot may have: of the root link suspension; of what statics carry mass
/// and first moments of every body that a joint moves, and the tilt of gravity; of every joint that
/// is driven by itself eccentricity (first and second harmonic), gear, coupling with its
/// neighbours, backlash, hysteresis and stiffening. Where the postures have times (`hours`: their
/// mean), also drift of the root link and creep of the markers of these names.
std::vector<Correction> PossibleCorrections(const RobotTree& tree, std::optional<double> hours,
                                            const std::vector<std::string>& markers = {});

/// Those that belong to the causes.
std::vector<Correction> CorrectionsOf(const std::vector<Correction>& all,
                                      const std::vector<std::string>& causes);

/// The causes of corrections, each once, in their order.
std::vector<std::string> CausesOf(const std::vector<Correction>& corrections);

}  // namespace elastocal
