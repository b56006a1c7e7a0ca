// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/parameters.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Known function of a posture that a correction multiplies. Of a joint's position q, its load m_z
/// and its largest torque (the URDF's effort):
enum class CorrectionShape {
  kSin,           ///< sin q: the encoder's disc is off centre
  kCos,           ///< cos q
  kSinTwice,      ///< sin 2q: the disc is an ellipse, or tilted
  kCosTwice,      ///< cos 2q
  kGear,          ///< q - centre: an error of the gear's ratio, or of a spindle's lead
  kCoupling,      ///< position of another joint - centre: tendons, differentials
  kBacklash,      ///< sign of the load, smooth where it is below a fiftieth of the effort
  kHysteresis,    ///< sign of the last motion: friction before the elastic part of a drive
  kStiffening,    ///< m_z |m_z| / effort^2: a spring whose stiffness depends on the load
  kSuspensionMx,  ///< moment of the weight about x of the root link, N.m
  kSuspensionMy,  ///< ... about y
  kHours,         ///< time - centre, h
};

/// An error of the robot that geometry and springs do not describe: a displacement of a joint, or
/// of the root link, by an unknown number times a known function of the posture.
struct Correction {
  std::string name;   ///< of the parameter: JOINT.SHAPE, waist.SHAPE
  std::string cause;  ///< the physical cause that it belongs to; several corrections may be one
  CorrectionShape shape = CorrectionShape::kGear;
  int joint = -1;       ///< whose position is corrected; -1: the root link's pose
  int axis = -1;        ///< of the root link: displacement along (0-2) or rotation about (3-5) it
  int source = -1;      ///< joint whose position counts (kCoupling)
  double centre = 0.0;  ///< position (time) at which the function is zero, rad or m (h)
  ParameterUnit unit = ParameterUnit::kRadian;
  double typical = 1e-3;  ///< standard deviation of the prior, in the unit
};

/// What a posture's corrections depend on beside joint positions and loads.
struct PostureHistory {
  /// By coordinate of q: direction of its last motion, -1 or 1; 0 or empty: unknown.
  Eigen::VectorXd approach;
  double hours = 0.0;
  /// Of the weight of all links about the origin of the root link, in its axes, N.m.
  Eigen::Vector3d root_moment = Eigen::Vector3d::Zero();
};

/// The functions at one posture, one for each correction. `load_z`: m_z by joint, N.m or N.
Eigen::VectorXd EvaluateShapes(const RobotTree& tree, const std::vector<Correction>& corrections,
                               const Eigen::VectorXd& q, const Eigen::VectorXd& load_z,
                               const PostureHistory& history);

/// All corrections that a robot may have: of every joint that is driven by itself
/// eccentricity (first and second harmonic), gear, coupling with its neighbours, backlash,
/// hysteresis and stiffening; of the root link suspension and, where the postures have times,
/// drift; `hours`: their mean.
std::vector<Correction> PossibleCorrections(const RobotTree& tree, std::optional<double> hours);

/// Those that belong to the causes.
std::vector<Correction> CorrectionsOf(const std::vector<Correction>& all,
                                      const std::vector<std::string>& causes);

/// The causes of corrections, each once, in their order.
std::vector<std::string> CausesOf(const std::vector<Correction>& corrections);

}  // namespace elastocal
