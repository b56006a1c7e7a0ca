// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/touch_table.hpp"

#include <algorithm>
#include <cmath>

namespace elastocal {
namespace {

constexpr double kTick = 0.01;  // s, period of the controller

/// The controller's answer to a contact, in the axes of the face.
struct Answer {
  Vector6d twist = Vector6d::Zero();  ///< m/s and rad/s
  bool flush = false;
};

Answer AnswerTo(const Vector6d& wrench, double edge, const TouchOptions& options) {
  constexpr double kGive = 2e-4;   // m/s for each N that is missing
  constexpr double kMiddle = 0.5;  // the force must act within this share of half the edge
  constexpr double kShare = 0.2;   // largest relative error of the force
  Answer answer;
  const double surplus = wrench[2] - options.force;
  answer.twist[2] = std::clamp(kGive * surplus, -options.approach, options.approach);
  if (wrench[2] <= 0.0) return answer;
  // Where the force acts, as a share of half the edge: it turns that side of the plate upwards.
  const Eigen::Vector2d at = Eigen::Vector2d(-wrench[4], wrench[3]) / (wrench[2] * 0.5 * edge);
  const Eigen::Vector2d turn = options.largest_turn * at.cwiseMax(-1.0).cwiseMin(1.0);
  answer.twist[3] = turn.y();
  answer.twist[4] = -turn.x();
  // It turns about where the force acts, not about the middle.
  answer.twist[2] -= 0.5 * edge * turn.dot(at);
  answer.flush = std::abs(surplus) < kShare * options.force && at.cwiseAbs().maxCoeff() < kMiddle;
  return answer;
}

}  // namespace

void MovePlate(const PhysicalPlate& described, const Vector6d& by, MovingChain& arm,
               Eigen::VectorXd& command) {
  constexpr double kDamping = 0.02;  // m and rad
  const auto& coordinates = arm.coordinates();
  Eigen::VectorXd x = command(coordinates);
  arm.Move(x);
  const Transform T_root_face =
      arm.link_poses()[static_cast<std::size_t>(described.link)] * described.T_link_face;
  const Eigen::Matrix3d R = T_root_face.linear().transpose();
  Eigen::MatrixXd J(6, arm.size());
  J << R * arm.PointJacobian(described.link, T_root_face.translation()),
      R * arm.RotationJacobian(described.link);
  Eigen::Matrix<double, 6, 6> gram = J * J.transpose();
  gram.diagonal().array() += kDamping * kDamping;
  x += J.transpose() * gram.ldlt().solve(by);
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    const RobotTree& tree = arm.tree();
    const int c = coordinates[i];
    const JointLimits& limits =
        tree.joints[static_cast<std::size_t>(tree.coordinate_joint[static_cast<std::size_t>(c)])]
            .limits;
    command[c] = std::clamp(x[static_cast<Eigen::Index>(i)], limits.lower, limits.upper);
  }
}

Touch TouchTable(VirtualRobot& robot, int plate, const PhysicalPlate& described, MovingChain& arm,
                 const TouchOptions& options, Eigen::VectorXd& command) {
  constexpr double kFirst = 0.5;       // N: a larger force means that the plate touches
  constexpr double kSettled_s = 0.3;   // the plate must be flush for this time
  constexpr double kPatience_s = 4.0;  // later it slows down: a stiff arm rocks from edge to edge
  const int steps = static_cast<int>(std::lround(kTick / robot.time_step_s()));
  Touch touch;
  Answer down;
  down.twist[2] = -options.approach;
  bool met = false;
  double flush_s = 0.0;
  for (; touch.time_s < options.longest_s && flush_s < kSettled_s; touch.time_s += kTick) {
    const Vector6d wrench = robot.PlateWrench(plate);
    met = met || wrench[2] > kFirst;
    const Answer answer = met ? AnswerTo(wrench, described.edge, options) : down;
    flush_s = answer.flush ? flush_s + kTick : 0.0;
    const double pace = std::exp2(-std::max(0.0, touch.time_s - kPatience_s));
    MovePlate(described, kTick * pace * answer.twist, arm, command);
    robot.Command(command);
    for (int i = 0; i < steps; ++i) robot.Step();
  }
  touch.flush = flush_s >= kSettled_s;
  return touch;
}

}  // namespace elastocal
