// SPDX-License-Identifier: Apache-2.0
#include "elastocal/motion/balance.hpp"

#include <cmath>

#include <Eigen/Sparse>

#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/math/smooth_step.hpp"
#include "elastocal/motion/sampled_motion.hpp"

namespace elastocal {
namespace {

/// The root link's way from `begin` to `end`, without regard to dynamics.
std::vector<Transform> RootWay(const Stretch& stretch) {
  std::vector<Transform> way(Size(stretch.sample_count()));
  for (std::size_t i = 0; i < way.size(); ++i) {
    const double s = SmoothStep(static_cast<double>(i) / static_cast<double>(way.size() - 1));
    way[i] = RootBetween(stretch.begin.T_world_root, stretch.end.T_world_root, s);
  }
  return way;
}

/// Places the legs at every sample, starting from the sample before. May turn the root link about
/// the vertical (see PlaceFeet).
bool PlaceLegs(const StandingRobot& robot, const Stretch& stretch,
               std::vector<Transform>& T_world_root, Eigen::MatrixXd& q) {
  PlacedPosture pose = stretch.begin;
  for (Eigen::Index i = 0; i < q.rows(); ++i) {
    const PlacedPosture before = pose;
    InterruptionPoint();
    pose = {stretch.q.row(i).transpose(), T_world_root[Size(i)]};
    const auto as_before = [&](int foot) {
      for (const int c : robot.legs[Size(foot)].coordinates()) pose.q[c] = before.q[c];
    };
    for (const int foot : stretch.standing) as_before(foot);
    if (!PlaceFeet(robot, stretch.standing, pose)) return false;
    if (stretch.led >= 0) {
      as_before(stretch.led);
      if (!PlaceSole(robot, stretch.led, stretch.T_world_led[Size(i)], pose)) return false;
    }
    T_world_root[Size(i)] = pose.T_world_root;
    q.row(i) = pose.q.transpose();
  }
  return true;
}

/// Share of a displacement of the root link that the centre of mass follows, along x and along y.
Eigen::Vector2d FollowingShare(const StandingRobot& robot, const Stretch& stretch) {
  constexpr double kStep = 1e-3;
  const auto com = [&](const Eigen::Vector2d& move) -> Eigen::Vector2d {
    PlacedPosture pose = stretch.begin;
    pose.T_world_root.translation().head<2>() += move;
    PlaceFeet(robot, stretch.standing, pose);
    return (pose.T_world_root * CentreOfMass(robot.tree, robot.inertias, pose.q)).head<2>();
  };
  const Eigen::Vector2d here = com({0, 0});
  return Eigen::Vector2d((com({kStep, 0}) - here).x(), (com({0, kStep}) - here).y()) / kStep;
}

/// Square of the ratio of the standing legs' joint speeds (norm) to the root link's speed, 1/m^2.
double SpeedGain(const StandingRobot& robot, const Stretch& stretch) {
  constexpr double kStep = 1e-3;
  PlacedPosture pose = stretch.begin;
  pose.T_world_root.translation() += Eigen::Vector3d(kStep, kStep, 0.0) / std::sqrt(2.0);
  PlaceFeet(robot, stretch.standing, pose);
  return ((pose.q - stretch.begin.q) / kStep).squaredNorm();
}

/// Effect of a displacement of the root on the zero-moment point and on joint speeds, as a band
/// matrix that is solved for corrections.
class CartOnTable {
 public:
  CartOnTable(int samples, double step, double share, double height_over_g, double speed_weight)
      : zmp_(samples, samples), speed_(samples, samples) {
    std::vector<Eigen::Triplet<double>> zmp, speed;
    const double second = share * height_over_g / (step * step);
    for (int i = 1; i + 1 < samples; ++i) {
      zmp.emplace_back(i, i - 1, -second);
      zmp.emplace_back(i, i, share + 2.0 * second);
      zmp.emplace_back(i, i + 1, -second);
    }
    for (int i = 0; i + 1 < samples; ++i) {
      speed.emplace_back(i, i, -std::sqrt(speed_weight) / step);
      speed.emplace_back(i, i + 1, std::sqrt(speed_weight) / step);
    }
    zmp_.setFromTriplets(zmp.begin(), zmp.end());
    speed_.setFromTriplets(speed.begin(), speed.end());
    const Eigen::SparseMatrix<double> normal =
        zmp_.transpose() * zmp_ + Eigen::SparseMatrix<double>(speed_.transpose() * speed_);
    const int inner = samples - 2 * kAtRest;
    solver_.compute(normal.block(kAtRest, kAtRest, inner, inner));
  }

  /// The correction of the root's way that compensates errors of the zero-moment point.
  Eigen::VectorXd Correct(const Eigen::VectorXd& error, const Eigen::VectorXd& way) const {
    const Eigen::VectorXd slope = -(zmp_.transpose() * error + speed_.transpose() * (speed_ * way));
    const Eigen::Index inner = slope.size() - 2 * kAtRest;
    Eigen::VectorXd correction = Eigen::VectorXd::Zero(slope.size());
    correction.segment(kAtRest, inner) = solver_.solve(slope.segment(kAtRest, inner));
    return correction;
  }

 private:
  static constexpr int kAtRest = 3;  // samples at either end
  Eigen::SparseMatrix<double> zmp_, speed_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

}  // namespace

Transform RootBetween(const Transform& begin, const Transform& end, double share) {
  const Eigen::Vector3d turn = RotationVector(end.linear() * begin.linear().transpose());
  Transform T = begin;
  T.translation() += share * (end.translation() - begin.translation());
  T.linear() = RotationFromVector(share * turn) * begin.linear();
  return T;
}

BalancedStretch Balance(const StandingRobot& robot, const Stretch& stretch,
                        const BalanceOptions& options) {
  BalancedStretch result;
  result.T_world_root = RootWay(stretch);
  result.q = stretch.q;
  if (!PlaceLegs(robot, stretch, result.T_world_root, result.q)) return result;
  const double step = 1.0 / stretch.rate_hz;
  const double height =
      (stretch.begin.T_world_root * CentreOfMass(robot.tree, robot.inertias, stretch.begin.q)).z();
  const Eigen::Vector2d share = FollowingShare(robot, stretch);
  const double speed_weight = options.velocity_weight * SpeedGain(robot, stretch);
  const auto cart = [&](int axis) {
    return CartOnTable(stretch.sample_count(), step, share[axis], height / -kGravity.z(),
                       speed_weight);
  };
  const CartOnTable carts[] = {cart(0), cart(1)};
  for (int pass = 0; pass < options.passes; ++pass) {
    result.zmp = ZeroMomentPoints(robot, result.q, result.T_world_root, step);
    for (int axis = 0; axis < 2; ++axis) {
      Eigen::VectorXd way(result.zmp.rows());
      for (Eigen::Index i = 0; i < way.size(); ++i) {
        way[i] = result.T_world_root[Size(i)].translation()[axis];
      }
      const Eigen::VectorXd error = result.zmp.col(axis) - stretch.zmp.col(axis);
      const Eigen::VectorXd moved = way + carts[axis].Correct(error, way);
      for (Eigen::Index i = 0; i < way.size(); ++i) {
        result.T_world_root[Size(i)].translation()[axis] = moved[i];
      }
    }
    if (!PlaceLegs(robot, stretch, result.T_world_root, result.q)) return result;
  }
  result.zmp = ZeroMomentPoints(robot, result.q, result.T_world_root, step);
  result.in_reach = true;
  return result;
}

}  // namespace elastocal
