// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

// Eq. 6: the support leg deflects under the load that the waist puts on it. A wrench is force [N],
// then moment [N.m]; a motion of the waist is the translation of the root link's origin [m], then
// the rotation [rad]. All are in the axes of the foot's link.

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Matrix6Xd = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// A support leg of the model in one posture.
struct LegPosture {
  int leg = 0;
  std::vector<Transform> T_ref_link;  ///< of all links
  Transform T_foot_waist;             ///< with the leg taken as rigid
  Matrix6Xd J_waist_q;  ///< motion of the waist by the leg's joints (in their order) while the foot
                        ///< is fixed
};

/// Places leg `leg` of the model in the posture q, with its joints deflected by `loads`.
LegPosture PlaceLeg(const ErrorModel& model, const Geometry& geometry, const Eigen::VectorXd& q,
                    int leg, const JointLoads& loads = {});

struct LegLoadOptions {
  /// Beyond this condition number a wrench from torques is unreliable, because the leg is nearly
  /// straight.
  double max_condition = 100.0;
  /// Length by which translations are divided to compare them with rotations, m. With 1 m the TALOS
  /// leg has a condition number of 9 to 17 for its knee at 2.0 to 0.86 rad, and of 145 at 0.1 rad.
  double length_scale = 1.0;
};

enum class LegLoadStatus {
  kReliable,
  kBadlyConditioned,  ///< there is a wrench, but it enlarges errors of the torques
  kIncomplete,        ///< a torque is NaN, and hence the wrench
};

struct LegLoad {
  LegLoadStatus status = LegLoadStatus::kReliable;
  Vector6d wrench = Vector6d::Zero();  ///< load on the waist, at the origin of the root link
  /// -J^{-T}: derivative of the wrench by the torques of the leg's joints. The derivative by the
  /// biases of their sensors is the opposite.
  Matrix6Xd wrench_by_torque;
  /// Condition number of J with translations divided by the length scale; infinite if J is
  /// singular.
  double condition = 1.0;
};

/// F = -J^{-T} tau (eq. 6), from the torques of the leg's joints (in their order, as the sensors
/// report them, less their biases).
///
/// The formula takes the leg for massless: a joint also bears the weight of the leg's links above
/// it, which is then taken for a load on the waist. Subtract LegWeightTorques from the torques to
/// avoid this.
///
/// The torques of a leg of fewer than six joints do not determine the wrench, and those of more
/// than six overdetermine it: the pseudo-inverse then gives the wrench of least norm, or of least
/// squares, with moments divided by the length scale. The wrench has no component in directions in
/// which J is singular (1e-12).
LegLoad LoadFromTorques(const LegPosture& posture, const Eigen::VectorXd& leg_torques,
                        const LegLoadOptions& options = {});

/// Torques by which the leg's joints hold the weight of the leg's own links, in the order of the
/// leg's joints: each joint holds the links between itself and the waist. The leg's own links are
/// those beyond its first joint, except another leg that hangs on it. The load of LoadFromTorques
/// contains that other leg, as if all joints carried it; for joints that do not, its weight is
/// taken off here. `gravity_ref` is in the reference frame, m/s^2.
Eigen::VectorXd LegWeightTorques(const ErrorModel& model, const LegPosture& posture,
                                 const Eigen::Vector3d& gravity_ref);

/// The load from a force-torque sensor in the leg: `measured` is what the surroundings exert on the
/// robot at the origin of the link `sensor_link`, in the axes of that link. The link's own body and
/// all beyond it (foot and floor) count as surroundings. The load is the opposite, less the weight
/// of the links between sensor and waist:
///
///   F = -(measured, moved to the waist) - (weight of the leg's links above the sensor's body)
///
/// Throws std::invalid_argument if the link is not on the leg.
Vector6d LoadFromWrench(const ErrorModel& model, const LegPosture& posture, int sensor_link,
                        const Vector6d& measured, const Eigen::Vector3d& gravity_ref);

/// The load by statics: the weight of all links except the leg's own, for a robot that stands on
/// this leg alone.
Vector6d LoadFromStatics(const ErrorModel& model, const LegPosture& posture,
                         const Eigen::Vector3d& gravity_ref);

/// Deflection of the waist (eq. 6): its origin moves by C_f F_f, and its rotation R becomes Exp(C_m
/// F_m) R.
struct WaistDeflection {
  Transform T_foot_waist;
  Matrix6d by_compliance;  ///< motion of the waist by the leg's six compliances
  Matrix6d by_wrench;      ///< motion of the waist by the wrench
};

/// `compliance` is ordered as in Geometry::leg_compliance.
WaistDeflection DeflectWaist(const Transform& T_foot_waist, const Vector6d& compliance,
                             const Vector6d& wrench);

}  // namespace elastocal
