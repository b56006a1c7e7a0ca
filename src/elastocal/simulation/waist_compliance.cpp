// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/waist_compliance.hpp"

#include <algorithm>

namespace elastocal {

WaistCompliance LumpedWaistCompliance(const TrueRobot& robot, const Leg& leg,
                                      const Eigen::VectorXd& posture, PhysicsOptions options) {
  // Servos are ten thousand times stiffer than in motion, so that the encoders keep their
  // positions.
  constexpr double kHeld = 1e4;
  constexpr double kForce = 20.0;
  constexpr double kMoment = 4.0;
  options.standing = Standing::kWelded;
  options.gravity = 0.0;  // the weight of the displaced robot would be a further load
  options.servo_stiffness *= kHeld;
  options.sliding_servo_stiffness *= kHeld;
  TrueRobot smooth = robot;
  smooth.friction.setZero();
  // The parts that the leg carries are made rigid, which is faster.
  for (std::size_t k = 0; k < smooth.tree.joints.size(); ++k) {
    const bool carries =
        std::find(leg.joints.begin(), leg.joints.end(), static_cast<int>(k)) != leg.joints.end();
    if (carries) continue;
    smooth.compliance[static_cast<Eigen::Index>(k)] = 0.0;
    smooth.link_compliance[k].setZero();
  }
  VirtualRobot body(smooth, {leg.foot_link}, posture, options);
  body.Settle();

  WaistCompliance result;
  const Eigen::Matrix3d R_world_foot = body.SolePose(0).linear();
  for (int i = 0; i < 6; ++i) {
    Vector6d wrench = Vector6d::Zero();
    wrench.segment<3>(i < 3 ? 0 : 3) = (i < 3 ? kForce : kMoment) * R_world_foot.col(i % 3);
    body.PushWaist(wrench);
    body.Settle();
    const Transform pushed = body.WaistPose();
    body.PushWaist(-wrench);
    body.Settle();
    const Transform pulled = body.WaistPose();
    const double span = 2.0 * (i < 3 ? kForce : kMoment);
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(pushed.linear() * pulled.linear().transpose()));
    result.C_foot.col(i).head<3>() =
        R_world_foot.transpose() * (pushed.translation() - pulled.translation()) / span;
    result.C_foot.col(i).tail<3>() = R_world_foot.transpose() * turn.axis() * turn.angle() / span;
  }
  result.stiffness = result.C_foot.diagonal().cwiseMax(1e-15).cwiseInverse();
  return result;
}

}  // namespace elastocal
