// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/robot/standing.hpp"
#include "elastocal/simulation/true_robot.hpp"

namespace elastocal {

/// How a robot stands.
enum class Standing {
  kWelded,  ///< its soles are held to the floor (see StandsFreely)
  kFree,    ///< its soles lie on the floor by contact and friction, and it may fall
};

/// The physics of the virtual robot.
struct PhysicsOptions {
  Standing standing = Standing::kWelded;
  double time_step_s = 0.005;
  double servo_stiffness = 5e4;  ///< stiffness of the encoder's side against the load, N.m/rad
  double sliding_servo_stiffness = 1e6;  ///< N/m
  double servo_frequency = 100.0;        ///< of the rotor on its servo, rad/s; critically damped
  /// Inertia and damping of the springs, as times, s; see MjcfModel.
  double spring_inertia_time_s = 0.010;
  double spring_damping_time_s = 0.020;
  /// Soles of the feet. A foot without an entry is flat, 0.20 m long and 0.12 m wide.
  std::vector<Sole> soles = {};
  double floor_friction = 0.8;
  double gravity = 9.81;  ///< m/s^2, downwards
  /// Rotation of gravity about x and y of the world: the floor on which the robot stands is not
  /// level.
  double gravity_tilt_x = 0.0, gravity_tilt_y = 0.0;  ///< rad
};

/// A flat square plate of the robot, which can lie on a table without friction. The contact is a
/// little soft: in MuJoCo it gives way by tenths of a millimetre under some tens of newtons.
struct PhysicalPlate {
  int link = 0;
  /// Pose of the middle of its face; z is the normal that points out of the table.
  Transform T_link_face = Transform::Identity();
  double edge = 0.08;  ///< m
};

/// MuJoCo's description (MJCF) of the true robot, z up, floor at z = 0.
///
/// - Each joint k of the tree has a motor hinge `m<k>`. Its passive spring is the servo: its rest
///   position is the command, and its position is what the encoder measures. In series with it,
///   about the same axis, is the elastic hinge `e<k>` with the joint's compliance. Prismatic joints
///   have slides instead of hinges. A joint of compliance 0 has no `e<k>`.
/// - An elastic link has three slides and three hinges half way to the joint k that it carries,
///   `x<k>_0..5`, or to the sole, `y<i>_0..5`.
/// - Bodies are called `b<index>`, far halves of elastic links `h<k>` (towards joint k), and soles
///   on which the robot stands `s<i>` (i: index into `support`).
/// - The root of the tree is the waist, with a floating joint: branches are shortest from there,
///   and MuJoCo's time grows with the square of their length. With Standing::kWelded, weld
///   constraints hold the soles to a micrometre; if the robot stands freely, they are boxes or
///   balls on the floor. Without support, the waist is fixed.
///
/// Springs are stiff (1e5 N.m/rad) for the small bodies that they carry. MuJoCo integrates damping
/// implicitly but stiffness explicitly. An elastic joint of stiffness k therefore has an additional
/// inertia of k t_i^2 (an "inerter", MuJoCo's armature: it resists relative acceleration, has no
/// weight, and does not move the equilibrium) and a damping of k t_d. With t_i = 10 ms and t_d = 20
/// ms every spring alone is critically damped, steps up to t_i are stable whatever the stiffness,
/// and deflections follow the load within some tens of milliseconds.
struct MjcfModel {
  std::string xml;
  std::vector<Transform> T_world_foot;              ///< poses of the soles of `support`
  Transform T_world_waist = Transform::Identity();  ///< when the robot is put down
};

/// Writes the model. `encoders` is the posture (by coordinate) in which the robot is put on the
/// floor. It decides where a second sole stands, so that the legs are not under stress except by
/// their errors. The first sole lies under the origin of the world's frame, with the attitude that
/// it has when the root link is upright in the zero posture of the description. Three or more balls
/// all touch the floor, as nearly as they can. Throws std::invalid_argument for a support that is
/// not the foot of a leg, and for kFree without support.
MjcfModel BuildMjcf(const TrueRobot& robot, const std::vector<int>& support,
                    const Eigen::VectorXd& encoders, const PhysicsOptions& options,
                    const std::vector<PhysicalPlate>& plates = {});

}  // namespace elastocal
