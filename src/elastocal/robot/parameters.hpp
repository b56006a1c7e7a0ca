// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace elastocal {

/// What an error parameter is. Geometric kinds (angles in rad, lengths in m) are those of eq. 1
/// and, for the first joint after the waist and after a branch, `kGamma` and `kB` (see
/// placement.hpp). Elastic kinds (eq. 5 to 7) are compliances (inverse stiffnesses) of joints about
/// their axes (`kTorsion`) and across them (`kBending`), compliances of a leg between its foot and
/// the waist by a force (`kLegForce`) and by a moment (`kLegMoment`), and the bias of a joint's
/// torque sensor (`kTorqueBias`). `kCorrection` is an error that neither geometry nor elasticity
/// describes (corrections.hpp). `kRod` (lengths) and `kMotorZero` (zeros of motors) are errors of
/// linkages (linkage.hpp).
enum class ParameterKind {
  kTheta,
  kR,
  kD,
  kB,
  kAlpha,
  kBeta,
  kGamma,
  kWaistPose,
  kMarker,
  kTorsion,
  kBending,
  kLegForce,
  kLegMoment,
  kTorqueBias,
  kCorrection,
  kRod,
  kMotorZero
};
inline constexpr int kParameterKindCount = 17;

enum class ParameterUnit {
  kRadian,
  kMetre,
  kRadianPerNewtonMetre,
  kMetrePerNewton,
  kNewtonMetre,
  kNewton,
  kRatio,
  kPerNewton,
  kMetrePerHour,
  kKilogram,
  kKilogramMetre,
  kMetrePerRadian,
  kRadianPerMetre
};
inline constexpr int kParameterUnitCount = 13;
inline constexpr int kRootAxis = 3;

/// One entry of the vector of errors: a deviation from the nominal model, zero at nominal.
struct Parameter {
  /// JOINT.theta|r|d|b|alpha|beta|gamma, waist.T0.gamma|b|alpha|d|theta|r or
  /// marker.MARKER.x|y|z (in the frame of the link that carries the marker); elastic ones
  /// JOINT.compliance_x|y|z (axes of its twisted frame, see mdh_frames.hpp: z is torsion), for the
  /// root link up to a joint on it JOINT.compliance_root_x|y|z (axes of the root link),
  /// LEG.compliance_x|y|z|rx|ry|rz (axes of its foot) and JOINT.torque_bias; of a linkage
  /// MOTOR.length|zero|radius|anchor_x ... centre_z (RodQuantity).
  std::string name;
  ParameterKind kind;
  ParameterUnit unit;
  int joint = -1;        ///< index into the robot tree's joints, for joint parameters
  int marker = -1;       ///< index into the error model's markers, for marker positions
  int leg = -1;          ///< index into the error model's legs, for their compliances and biases
  int axis = -1;         ///< axis of a compliance: 0, 1, 2 for x, y, z (rx, ry, rz); kRootAxis + 0,
                         ///< 1, 2 for one of the root link
  int correction = -1;   ///< index into Elasticity::corrections, for corrections
  double typical = 0.0;  ///< for corrections and linkages: standard deviation of the prior
  int linkage = -1;      ///< index into the robot tree's linkages, for their parameters
};

/// Name of a kind in parameter names and settings: theta, r, d, b, alpha, beta, gamma, T0, marker,
/// torsion, bending, base_force, base_moment, torque_bias, correction, rod, motor_zero.
const char* KindName(ParameterKind kind);

/// SI text of a unit: rad, m, rad/(N.m), m/N, N.m, N, 1, 1/N, m/h, kg, kg.m, m/rad,
/// rad/m.
const char* UnitName(ParameterUnit unit);

/// Whether a kind of joint parameter is an angle: theta, alpha, beta, gamma, motor_zero.
bool IsAngle(ParameterKind kind);

/// Whether the parameter belongs to the experiment (pose of the waist, marker positions) and not to
/// the robot. Such parameters are fitted anew for every recording and never deployed.
bool IsExternal(ParameterKind kind);

/// Whether the kind is a compliance, which is zero for a rigid robot and never negative.
bool IsCompliance(ParameterKind kind);

/// Whether the parameter acts through loads (a compliance or a torque bias) or is a correction.
/// Geometry alone says nothing about it, and a URDF has no place for it: the data, not QR, decide
/// whether it is identifiable.
bool IsElastic(ParameterKind kind);

/// Index of the parameter called `name`. Throws InputError with the nearest known name.
int FindParameter(const std::vector<Parameter>& parameters, const std::string& name);

/// Indices, ascending, of the parameters whose names match any of the patterns; `*` stands for any
/// run of characters. A pattern may match nothing: it may concern a part that was not recorded.
std::vector<int> MatchParameters(const std::vector<Parameter>& parameters,
                                 const std::vector<std::string>& patterns);

/// Throws InputError, with the nearest known name, for a pattern that matches nothing.
void CheckPatterns(const std::vector<Parameter>& parameters,
                   const std::vector<std::string>& patterns);

}  // namespace elastocal
