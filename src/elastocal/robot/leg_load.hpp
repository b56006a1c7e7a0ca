#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

// Eq. 6: the waist gives way on its supporting leg under the load that it puts there. A wrench is
// force [N], then moment [N.m]; a motion of the waist is the translation of the root link's origin
// [m], then the rotation [rad]. All in the axes of the foot's link.

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Matrix6Xd = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// A leg of the model that stands, in one posture.
struct LegPosture {
  int leg = 0;
  std::vector<Transform> T_ref_link;  ///< of all links
  Transform T_foot_waist;             ///< of the rigid leg
  Matrix6Xd J_waist_q;  ///< motion of the waist by the leg's joints (in their order), foot fixed
};

LegPosture PlaceLeg(const ErrorModel& model, const Geometry& geometry, const Eigen::VectorXd& q,
                    int leg, const JointLoads& loads = {});

struct LegLoadOptions {
  /// A wrench from torques is unreliable beyond this condition number: the leg is nearly straight.
  double max_condition = 100.0;
  /// Length by which translations are divided so that they compare with rotations, m. With 1 m the
  /// TALOS leg has 9 to 17 with its knee at 2.0 to 0.86 rad, and 145 at 0.1 rad.
  double length_scale = 1.0;
};

enum class LegLoadStatus {
  kReliable,
  kBadlyConditioned,  ///< the wrench is there, but errors of the torques are much enlarged in it
  kIncomplete,        ///< a torque is NaN, hence the wrench
};

struct LegLoad {
  LegLoadStatus status = LegLoadStatus::kReliable;
  Vector6d wrench = Vector6d::Zero();  ///< load on the waist, at the origin of the root link
  /// -J^{-T}: derivative of the wrench by the torques of the leg's joints. That by their biases is
  /// the opposite.
  Matrix6Xd wrench_by_torque;
  /// Of J with translations divided by the length scale; infinite where J is singular.
  double condition = 1.0;
};

/// F = -J^{-T} tau (eq. 6), from the torques of the leg's joints (in their order, as the sensors
/// report them, biases taken off).
///
/// As if the leg had no mass: the weight of its links above a joint, which the joint bears as well,
/// is taken for a load on the waist. Subtract LegWeightTorques from the torques to avoid it.
///
/// A leg of fewer than six joints does not feel all of the wrench, one of more feels some of it
/// twice: the pseudo-inverse gives the wrench of least norm, and least squares, with moments
/// divided by the length scale. Directions in which J is singular (1e-12) are left out of the
/// wrench.
LegLoad LoadFromTorques(const LegPosture& posture, const Eigen::VectorXd& leg_torques,
                        const LegLoadOptions& options = {});

/// Torques by which the leg's joints hold the leg's own links (what is beyond its first joint): of
/// each joint, of the links between it and the waist. `gravity_ref` in the reference frame, m/s^2.
Eigen::VectorXd LegWeightTorques(const ErrorModel& model, const LegPosture& posture,
                                 const Eigen::Vector3d& gravity_ref);

/// The load from a force-torque sensor in the leg: `measured` is what the surroundings exert on the
/// robot at the origin of the link `sensor_link`, in the axes of that link. The link's own body and
/// all beyond it (foot and floor) count as surroundings. The load is the opposite less what carries
/// the links between sensor and waist:
///
///   F = -(measured, moved to the waist) - (weight of the leg's links above the sensor's body)
///
/// Throws std::invalid_argument where the link is not on the leg.
Vector6d LoadFromWrench(const ErrorModel& model, const LegPosture& posture, int sensor_link,
                        const Vector6d& measured, const Eigen::Vector3d& gravity_ref);

/// The load by statics: the weight of all links but the leg's (what is beyond its first joint), for
/// a robot that stands on this leg alone.
Vector6d LoadFromStatics(const ErrorModel& model, const LegPosture& posture,
                         const Eigen::Vector3d& gravity_ref);

/// The waist as it gives way (eq. 6): its origin moves by C_f F_f, and it turns to Exp(C_m F_m) R.
struct WaistDeflection {
  Transform T_foot_waist;
  Matrix6d by_compliance;  ///< motion of the waist by the leg's six compliances
  Matrix6d by_wrench;      ///< motion of the waist by the wrench
  /// Motion of the waist by the biases of the leg's torque sensors, where the wrench is theirs.
  Matrix6Xd ByTorqueBias(const LegLoad& load) const { return -by_wrench * load.wrench_by_torque; }
};

/// `compliance` as in Geometry::leg_compliance.
WaistDeflection DeflectWaist(const Transform& T_foot_waist, const Vector6d& compliance,
                             const Vector6d& wrench);

}  // namespace elastocal
