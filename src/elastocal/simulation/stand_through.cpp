// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/stand_through.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {
namespace {

constexpr double kLongestSettling = 4.0;  // s
constexpr double kLook = 0.01;            // s between two looks at the robot
constexpr double kLoaded = 0.05;  // share of the weight on a sole from which on it is loaded

/// The samples before and after a time, and the share of the second one. `at` moves along with the
/// time.
struct Between {
  Eigen::Index at = 0;
  double share = 0.0;

  Eigen::VectorXd Of(const Eigen::MatrixXd& q) const {
    return (q.row(at) + share * (q.row(at + 1) - q.row(at))).transpose();
  }
};

void MoveTo(const JointMotion& motion, double time_s, Between& between) {
  Eigen::Index& at = between.at;
  while (at + 2 < motion.time_s.size() && motion.time_s[at + 1] <= time_s) ++at;
  const double span = motion.time_s[at + 1] - motion.time_s[at];
  between.share = std::clamp((time_s - motion.time_s[at]) / span, 0.0, 1.0);
}

/// Distance of the zero-moment point to the edge of the loaded soles, m.
double ZmpMargin(const VirtualRobot& body, const std::vector<Sole>& soles) {
  const auto [force, moment] = body.FloorWrench();
  std::vector<Sole> standing;
  std::vector<Transform> T_world_sole;
  for (std::size_t i = 0; i < soles.size(); ++i) {
    const Transform T = body.SolePose(static_cast<int>(i));
    const double pressed = T.linear().row(2).dot(body.SoleWrench(static_cast<int>(i)).head<3>());
    if (!(pressed > kLoaded * force.z())) continue;
    standing.push_back(soles[i]);
    T_world_sole.push_back(T);
  }
  if (standing.empty()) return -std::numeric_limits<double>::infinity();
  return InsideMargin(SupportPolygon(standing, T_world_sole), ZeroMomentPoint(force, moment));
}

/// What those who put a robot down do with their hands: they turn its waist upright, with the
/// moment of a spring that would hold its weight twice over and of a damper, in the world's axes.
class Hands {
 public:
  /// `height`: of what they hold, m.
  Hands(const TrueRobot& robot, const VirtualRobot& body, double height)
      : stiffness_(2.0 * TotalMass(robot.tree) * kGravity.norm() * height),
        before_(body.WaistPose().linear()) {}

  Vector6d Hold(const VirtualRobot& body, double interval_s) {
    constexpr double kDamping = 0.15;  // s
    const Eigen::Matrix3d R = body.WaistPose().linear();
    const Eigen::Vector3d lean = Eigen::Vector3d::UnitZ().cross(R.col(2));
    const Eigen::Vector3d speed = RotationVector(R * before_.transpose()) / interval_s;
    before_ = R;
    Vector6d wrench = Vector6d::Zero();
    wrench.tail<3>() = -stiffness_ * (lean + kDamping * speed);
    return wrench;
  }

 private:
  double stiffness_;  // N.m/rad
  Eigen::Matrix3d before_;
};

/// `R_root_unit`: how the inertial unit is mounted.
StandingSense Sense(const VirtualRobot& body, std::size_t soles,
                    const Eigen::Matrix3d& R_root_unit) {
  StandingSense sense;
  sense.R_world_root = body.WaistPose().linear() * R_root_unit;
  sense.wrenches.resize(6, static_cast<Eigen::Index>(soles));
  for (Eigen::Index i = 0; i < sense.wrenches.cols(); ++i) {
    sense.wrenches.col(i) = body.SoleWrench(static_cast<int>(i));
  }
  return sense;
}

double TrackingError(const TrueRobot& robot, const Eigen::VectorXd& encoders,
                     const Eigen::VectorXd& command) {
  double largest = 0.0;
  for (std::size_t k = 0; k < robot.tree.joints.size(); ++k) {
    const double wanted = JointPosition(robot.tree.joints[k], command);
    largest = std::max(largest, std::abs(encoders[static_cast<Eigen::Index>(k)] - wanted));
  }
  return largest;
}

}  // namespace

StandingRun StandThrough(const TrueRobot& robot, const std::vector<Sole>& soles,
                         const JointMotion& motion, PhysicsOptions physics,
                         const StandThroughOptions& options) {
  physics.standing = Standing::kFree;
  physics.soles = soles;
  std::vector<int> feet;
  for (const Sole& sole : soles) feet.push_back(sole.link);
  const Eigen::MatrixXd& commanded = options.commanded != nullptr ? *options.commanded : motion.q;
  VirtualRobot body(robot, feet, commanded.row(0).transpose(), physics);
  const double height = body.Height();
  const long per_look = std::max(1L, std::lround(kLook / body.time_step_s()));
  const double interval = static_cast<double>(per_look) * body.time_step_s();
  Eigen::Matrix3d R_root_unit = Eigen::Matrix3d::Identity();
  Eigen::VectorXd correction = Eigen::VectorXd::Zero(motion.q.cols());
  const auto correct = [&](Eigen::Index sample, const Eigen::VectorXd& planned,
                           const StandingSense& sense) {
    const std::vector<int>& support = motion.support[static_cast<std::size_t>(sample)];
    correction = options.stabiliser->Correct(planned, support, sense, interval) - planned;
  };
  if (options.stabiliser == nullptr || options.R_world_root_at_rest) {
    body.Settle(kLongestSettling);
    if (options.R_world_root_at_rest) {
      R_root_unit = body.WaistPose().linear().transpose() * *options.R_world_root_at_rest;
      if (options.stabiliser != nullptr) {
        options.stabiliser->TakeRest(motion.q.row(0).transpose(), motion.support.front(),
                                     Sense(body, soles.size(), R_root_unit));
      }
    }
  } else {  // the hands let go slowly, so that a robot with errors stands by itself at the end
    Hands hands(robot, body, height);
    const long looks = std::lround(kLongestSettling / interval);
    for (long i = 0; i < looks; ++i) {
      const double held = 1.0 - static_cast<double>(i + 1) / static_cast<double>(looks);
      body.Command(commanded.row(0).transpose() + correction);
      for (long step = 0; step < per_look; ++step) {
        body.PushWaist(held * hands.Hold(body, body.time_step_s()));
        body.Step();
      }
      correct(0, motion.q.row(0).transpose(), Sense(body, soles.size(), R_root_unit));
    }
    body.PushWaist(Vector6d::Zero());
  }
  const Transform begin = body.WaistPose();
  StandingRun run;
  run.least_zmp_margin = std::numeric_limits<double>::infinity();
  const double first = motion.time_s[0], last = motion.time_s[motion.time_s.size() - 1];
  const auto steps = static_cast<long>(std::floor((last - first) / body.time_step_s()));
  Between now;
  for (long i = 1; i <= steps; ++i) {
    run.time_s = static_cast<double>(i) * body.time_step_s();
    MoveTo(motion, first + run.time_s, now);
    body.Command(now.Of(commanded) + correction);
    body.Step();
    if (i % per_look != 0) continue;
    const Transform waist = body.WaistPose();
    if (body.FallenFrom(height)) return run;
    const double upright = waist.linear().col(2).dot(begin.linear().col(2));
    run.largest_lean = std::max(run.largest_lean, std::acos(std::clamp(upright, -1.0, 1.0)));
    run.tracking = std::max(run.tracking,
                            TrackingError(robot, body.Encoders(), now.Of(commanded) + correction));
    const StandingSense sense = Sense(body, soles.size(), R_root_unit);
    run.least_zmp_margin = std::min(run.least_zmp_margin, ZmpMargin(body, soles));
    const Eigen::VectorXd planned = now.Of(motion.q);
    if (options.watch) options.watch(now.at, planned, body);
    if (options.stabiliser == nullptr) continue;
    correct(now.at, planned, sense);
    run.largest_shift = std::max(run.largest_shift, options.stabiliser->shift().norm());
  }
  run.stood = true;
  return run;
}

}  // namespace elastocal
