#include "elastocal/simulation/stand_through.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace elastocal {
namespace {

constexpr double kLongestSettling = 4.0;  // s
constexpr double kFallen = 0.7;  // share of the waist's height below which the robot has fallen

/// The command at a time; `at` moves along with the time.
Eigen::VectorXd CommandAt(const JointMotion& motion, double time_s, Eigen::Index& at) {
  while (at + 2 < motion.time_s.size() && motion.time_s[at + 1] <= time_s) ++at;
  const double span = motion.time_s[at + 1] - motion.time_s[at];
  const double share = std::clamp((time_s - motion.time_s[at]) / span, 0.0, 1.0);
  return (motion.q.row(at) + share * (motion.q.row(at + 1) - motion.q.row(at))).transpose();
}

/// Distance of the zero-moment point to the edge of the loaded soles, m.
double ZmpMargin(const VirtualRobot& body, const std::vector<Sole>& soles,
                 const StandingSense& sense) {
  constexpr double kPressed = 50.0;  // N
  std::vector<Sole> standing;
  std::vector<Transform> T_world_sole;
  for (std::size_t i = 0; i < soles.size(); ++i) {
    if (!(sense.wrenches(2, static_cast<Eigen::Index>(i)) > kPressed)) continue;
    standing.push_back(soles[i]);
    T_world_sole.push_back(body.SolePose(static_cast<int>(i)));
  }
  if (standing.empty()) return -std::numeric_limits<double>::infinity();
  const auto [force, moment] = body.FloorWrench();
  return InsideMargin(SupportPolygon(standing, T_world_sole), ZeroMomentPoint(force, moment));
}

StandingSense Sense(const VirtualRobot& body, std::size_t soles) {
  StandingSense sense;
  sense.R_world_root = body.WaistPose().linear();
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
                         const JointMotion& motion, PhysicsOptions options,
                         Stabiliser* stabiliser) {
  options.standing = Standing::kFree;
  options.foot_length = soles.front().upper.x() - soles.front().lower.x();
  options.foot_width = soles.front().upper.y() - soles.front().lower.y();
  std::vector<int> feet;
  for (const Sole& sole : soles) feet.push_back(sole.link);
  VirtualRobot body(robot, feet, motion.q.row(0).transpose(), options);
  body.Settle(kLongestSettling);
  const Transform begin = body.WaistPose();
  StandingRun run;
  run.least_zmp_margin = std::numeric_limits<double>::infinity();
  const double first = motion.time_s[0], last = motion.time_s[motion.time_s.size() - 1];
  const auto steps = static_cast<long>(std::floor((last - first) / body.time_step_s()));
  const long per_look = std::max(1L, std::lround(0.01 / body.time_step_s()));
  Eigen::Index at = 0;
  Eigen::VectorXd correction = Eigen::VectorXd::Zero(motion.q.cols());
  for (long i = 1; i <= steps; ++i) {
    run.time_s = static_cast<double>(i) * body.time_step_s();
    const Eigen::VectorXd planned = CommandAt(motion, first + run.time_s, at);
    body.Command(planned + correction);
    body.Step();
    if (i % per_look != 0) continue;
    const Transform waist = body.WaistPose();
    if (!(waist.translation().z() > kFallen * begin.translation().z())) return run;
    const double upright = waist.linear().col(2).dot(begin.linear().col(2));
    run.largest_lean = std::max(run.largest_lean, std::acos(std::clamp(upright, -1.0, 1.0)));
    run.tracking =
        std::max(run.tracking, TrackingError(robot, body.Encoders(), planned + correction));
    const StandingSense sense = Sense(body, soles.size());
    run.least_zmp_margin = std::min(run.least_zmp_margin, ZmpMargin(body, soles, sense));
    if (stabiliser == nullptr) continue;
    const double interval = static_cast<double>(per_look) * body.time_step_s();
    const std::vector<int>& support = motion.support[static_cast<std::size_t>(at)];
    correction = stabiliser->Correct(planned, support, sense, interval) - planned;
    run.largest_shift = std::max(run.largest_shift, stabiliser->shift().norm());
  }
  run.stood = true;
  return run;
}

}  // namespace elastocal
