// SPDX-License-Identifier: Apache-2.0
#include "elastocal/motion/joint_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "elastocal/math/bspline.hpp"
#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/rrt_connect.hpp"

namespace elastocal {
namespace {

/// Integral of products of the splines' derivatives, control points x control points.
Eigen::MatrixXd VelocityMetric(int control_points) {
  constexpr int kSamples = 201;
  const Eigen::MatrixXd slope = QuinticSplineBasisRows(control_points, kSamples, 1);
  return slope.transpose() * slope / (kSamples - 1);
}

/// Way points of the way from 0 to 1 with the least velocity.
Eigen::VectorXd WayFractions(const Eigen::MatrixXd& metric) {
  const Eigen::Index free = metric.rows() - 6;
  return -metric.block(3, 3, free, free)
              .ldlt()
              .solve(metric.block(3, free + 3, free, 3).rowwise().sum());
}

/// Way points of the straight way, way points x coordinates.
Eigen::MatrixXd StraightWay(const Eigen::MatrixXd& metric, const Eigen::VectorXd& from,
                            const Eigen::VectorXd& to) {
  const Eigen::VectorXd fractions = WayFractions(metric);
  return from.transpose().replicate(fractions.size(), 1) + fractions * (to - from).transpose();
}

double Least(const Eigen::VectorXd& distances) {
  return distances.size() > 0 ? distances.minCoeff() : std::numeric_limits<double>::infinity();
}

/// Moves way points so that parts of the robot are further from each other.
class WayAround {
 public:
  WayAround(const StandingRobot& robot, const Clearances& clearances,
            const std::vector<int>& moving, const JointPathOptions& options,
            const Eigen::MatrixXd& metric, double least_at_ends)
      : robot_(robot),
        clearances_(clearances),
        moving_(moving),
        clearance_(std::min(options.clearance, least_at_ends)),
        basis_(QuinticSplineBasisRows(static_cast<int>(metric.rows()),
                                      static_cast<int>(std::lround(1.0 / options.check_step)) + 1)),
        solver_(metric.block(3, 3, metric.rows() - 6, metric.rows() - 6)) {}

  /// Least distance between parts on the way, m.
  double Clearance(const Eigen::MatrixXd& control) const {
    double least = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 0; i < basis_.rows(); ++i) least = std::min(least, Least(At(control, i)));
    return least;
  }

  /// Least distance that the way should keep, except at its ends.
  double wanted() const { return clearance_; }

  /// Pushes the way away from what is too near, and keeps the best one.
  void Bend(int iterations, JointPath& path) const {
    constexpr double kFirstStep = 0.15;  // first step: largest change of a coordinate, rad
    constexpr double kShrink = 0.96;
    Eigen::MatrixXd control = path.control;
    double length = kFirstStep;
    for (int i = 0; i < iterations && path.clearance < wanted(); ++i) {
      if (!StepAway(length, control)) break;
      length *= kShrink;
      const double clearance = Clearance(control);
      if (clearance <= path.clearance) continue;
      path.clearance = clearance;
      path.control = control;
    }
  }

 private:
  /// Takes one step of the given length. Returns false if no parts are too near, or if way points
  /// cannot help.
  bool StepAway(double length, Eigen::MatrixXd& control) const {
    const Eigen::Index free = control.rows() - 6;
    Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(free, control.cols());
    for (Eigen::Index i = 0; i < basis_.rows(); ++i) {
      const Eigen::VectorXd distances = At(control, i);
      if (Least(distances) >= clearance_) continue;
      const Eigen::VectorXd away = Away(control.transpose() * basis_.row(i).transpose(), distances);
      slope += basis_.row(i).segment(3, free).transpose() * away.transpose();
    }
    if (slope.norm() < 1e-12) return false;
    Eigen::MatrixXd move = solver_.solve(slope);
    move *= length / move.cwiseAbs().maxCoeff();
    control.middleRows(3, free) += move;
    for (const int c : moving_) {
      const JointLimits& limits =
          robot_.tree.joints[Size(robot_.tree.coordinate_joint[Size(c)])].limits;
      const double margin = robot_.limits.position_margin;
      for (Eigen::Index r = 3; r < free + 3; ++r) {
        control(r, c) = std::clamp(control(r, c), std::min(limits.lower + margin, control(0, c)),
                                   std::max(limits.upper - margin, control(0, c)));
      }
    }
    return true;
  }

  Eigen::VectorXd At(const Eigen::MatrixXd& control, Eigen::Index sample) const {
    InterruptionPoint();
    return clearances_(control.transpose() * basis_.row(sample).transpose());
  }

  double Lack(const Eigen::VectorXd& distances) const {
    return (clearance_ - distances.array()).max(0.0).square().sum();
  }

  /// Direction in which the lack of distance decreases.
  Eigen::VectorXd Away(Eigen::VectorXd q, const Eigen::VectorXd& distances) const {
    constexpr double kStep = 1e-4;
    Eigen::VectorXd away = Eigen::VectorXd::Zero(q.size());
    const double lack = Lack(distances);
    for (const int c : moving_) {
      const double at = q[c];
      InterruptionPoint();
      q[c] = at + kStep;
      away[c] = (lack - Lack(clearances_(q))) / kStep;
      q[c] = at;
    }
    return away;
  }

  const StandingRobot& robot_;
  const Clearances& clearances_;
  const std::vector<int>& moving_;
  double clearance_;
  Eigen::MatrixXd basis_;
  Eigen::LDLT<Eigen::MatrixXd> solver_;
};

/// The postures between two others in which parts are `clearance` apart; its dimensions are the
/// `moving` coordinates, and all others stay half way.
FreeSpace PosturesBetween(const StandingRobot& robot, const Clearances& clearances,
                          const Eigen::VectorXd& from, const Eigen::VectorXd& to,
                          const std::vector<int>& moving, double clearance) {
  FreeSpace space;
  const double margin = robot.limits.position_margin;
  space.lower.resize(static_cast<Eigen::Index>(moving.size()));
  space.upper = space.lower;
  for (std::size_t i = 0; i < moving.size(); ++i) {
    const int c = moving[i];
    const Joint& joint = robot.tree.joints[Size(robot.tree.coordinate_joint[Size(c)])];
    const auto [lower, upper] = PostureRange(joint, 0.0, robot.rest[c]);
    space.lower[static_cast<Eigen::Index>(i)] = std::min({lower + margin, from[c], to[c]});
    space.upper[static_cast<Eigen::Index>(i)] = std::max({upper - margin, from[c], to[c]});
  }
  space.free = [&, clearance, q = Eigen::VectorXd(0.5 * (from + to))](const Eigen::VectorXd& x) {
    InterruptionPoint();
    Eigen::VectorXd there = q;
    there(moving) = x;
    return Least(clearances(there)) >= clearance;
  };
  return space;
}

/// Puts a way that is not free on a detour, if that keeps parts further from each other. Only
/// coordinates that differ at the ends take part in the detour.
void GoByDetour(const StandingRobot& robot, const Clearances& clearances,
                const std::vector<int>& moving, const JointPathOptions& options,
                double least_at_ends, JointPath& path) {
  constexpr double kSame = 1e-3;                // rad or m
  constexpr double kSpare = 1.1, kShare = 0.7;  // the spline cuts corners; ends may be at limits
  const Eigen::VectorXd from = path.control.row(0).transpose();
  const Eigen::VectorXd to = path.control.bottomRows<1>().transpose();
  std::vector<int> differing;
  for (const int c : moving) {
    if (std::abs(to[c] - from[c]) > kSame) differing.push_back(c);
  }
  if (differing.empty()) differing = moving;
  const double clearance = std::min(
      options.clearance, std::max(kSpare * robot.limits.clearance, kShare * least_at_ends));
  const FreeSpace space = PosturesBetween(robot, clearances, from, to, differing, clearance);
  const auto corners = ConnectByTrees(space, from(differing), to(differing));
  if (!corners) return;
  const int sides = static_cast<int>(corners->rows()) - 1;
  const int way_points = options.way_points * sides;
  const Eigen::MatrixXd metric = VelocityMetric(way_points + 6);
  Eigen::MatrixXd way = StraightWay(metric, from, to);
  way(Eigen::all, differing) = AlongPolygon(*corners, way_points);
  JointPath detour{RestToRestSpline(from, way, to), options.duration_s * sides, 0.0};
  const WayAround around(robot, clearances, moving, options, metric, least_at_ends);
  detour.clearance = around.Clearance(detour.control);
  around.Bend(options.iterations, detour);
  if (detour.clearance > path.clearance) path = detour;
}

/// Shortest duration of a way for which all joints stay below their velocity limits, s.
double LeastDuration(const StandingRobot& robot, const Eigen::MatrixXd& control) {
  constexpr int kSamples = 101;
  const Eigen::MatrixXd slope =
      QuinticSplineBasisRows(static_cast<int>(control.rows()), kSamples, 1) * control;
  double duration = 0.0;
  for (const Joint& joint : robot.tree.joints) {
    Eigen::VectorXd rate = Eigen::VectorXd::Zero(slope.rows());
    for (const Drive& drive : DrivesOf(joint)) {
      rate += drive.multiplier * slope.col(drive.coordinate);
    }
    const double fastest = rate.cwiseAbs().maxCoeff();
    duration = std::max(duration, fastest / (robot.limits.velocity_share * joint.limits.velocity));
  }
  return duration;
}

}  // namespace

JointPath PlanJointPath(const StandingRobot& robot, const Clearances& clearances,
                        const Eigen::VectorXd& from, const Eigen::VectorXd& to,
                        const std::vector<int>& moving, const JointPathOptions& options) {
  const Eigen::MatrixXd metric = VelocityMetric(options.way_points + 6);
  JointPath path;
  path.control = RestToRestSpline(from, StraightWay(metric, from, to), to);
  path.duration_s = options.duration_s;
  path.clearance = std::numeric_limits<double>::infinity();
  if (clearances) {
    const double at_ends = std::min(Least(clearances(from)), Least(clearances(to)));
    const WayAround around(robot, clearances, moving, options, metric, at_ends);
    path.clearance = around.Clearance(path.control);
    around.Bend(options.iterations, path);
    if (path.clearance < around.wanted()) {
      GoByDetour(robot, clearances, moving, options, at_ends, path);
    }
  }
  path.duration_s = std::max(path.duration_s, LeastDuration(robot, path.control));
  return path;
}

Eigen::MatrixXd SamplePath(const JointPath& path, double rate_hz) {
  const int samples = static_cast<int>(std::ceil(path.duration_s * rate_hz - 1e-9)) + 1;
  return QuinticSplineBasisRows(static_cast<int>(path.control.rows()), samples) * path.control;
}

}  // namespace elastocal
