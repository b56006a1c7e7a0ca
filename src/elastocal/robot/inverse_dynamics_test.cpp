// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/inverse_dynamics.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "tests/random_robot.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

using Eigen::Vector3d;

void GiveInertias(RobotTree& tree, Random& random) {
  for (Link& link : tree.links) {
    link.mass = random.Uniform(0.1, 5.0);
    link.com = random.NormalVector(3, 0.1);
    const Eigen::Vector3d size = random.NormalVector(3, 0.1);
    link.inertia =
        link.mass * (size.squaredNorm() * Eigen::Matrix3d::Identity() - size * size.transpose());
  }
}

RobotState AtRest(const Eigen::VectorXd& q) {
  RobotState state;
  state.q = q;
  state.velocity = state.acceleration = Eigen::VectorXd::Zero(q.size());
  return state;
}

TEST(InverseDynamics, PendulumByHand) {
  // A mass of 2 kg at 0.5 m along x, which turns about y at 3 rad/s and 4 rad/s^2.
  RobotTree tree = MakeRoot();
  const int link = AddJoint(tree, "joint", 0, Transform::Identity(), {0, 1, 0});
  tree.links[link].mass = 2.0;
  tree.links[link].com = {0.5, 0, 0};
  RobotState state = AtRest(Eigen::VectorXd::Zero(1));
  state.velocity[0] = 3.0;
  state.acceleration[0] = 4.0;
  const auto found = InverseDynamics(tree, BodyInertias(tree), state, {0, 0, -10});
  // Positive is downwards about y: gravity helps with 2 * 10 * 0.5, inertia needs 2 * 0.5^2 * 4.
  EXPECT_NEAR(found.torques[0], 2.0 - 10.0, 1e-14);
  // The force is 2 * 0.5 * 9 towards the axis, and 2 * 0.5 * 4 less than the weight upwards.
  EXPECT_LT((found.force - Vector3d(-9.0, 0.0, 20.0 - 4.0)).norm(), 1e-14);
}

TEST(InverseDynamics, AtRestIsStatics) {
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    RobotTree tree = RandomRobot(kUsualRelations, random);
    GiveInertias(tree, random);
    const Eigen::VectorXd q = RandomPosture(tree, random);
    const Vector3d gravity = random.NormalVector(3, 6.0);
    const auto inertias = BodyInertias(tree);
    const auto held = InverseDynamics(tree, inertias, AtRest(q), gravity);
    // Torques are some hundred N.m, and rounding is about 1e-13.
    EXPECT_LT((held.torques - GravityTorques(tree, q, gravity)).norm(), 1e-10);
    EXPECT_LT((held.com - CentreOfMass(tree, inertias, q)).norm(), 1e-12);
    // If the robot stands on this link, the wrench of the floor is the only one.
    const int foot = random.Index(static_cast<int>(tree.links.size()));
    const auto standing =
        InverseDynamics(tree, inertias, AtRest(q), gravity, {{foot, held.force, held.moment}});
    EXPECT_LT((standing.torques - StaticTorques(tree, q, gravity, foot)).norm(), 1e-10);
    EXPECT_LT(standing.force.norm() + standing.moment.norm(), 1e-10);
  }
}

TEST(InverseDynamics, PowerIsTheChangeOfEnergy) {
  // A floating robot without gravity and contact keeps its momentum. If a wrench on its root and
  // its motors move it, they change its energy by their power.
  Random random(4);
  RobotTree tree = RandomRobot(kUsualRelations, random);
  GiveInertias(tree, random);
  const auto inertias = BodyInertias(tree);
  RobotState state = AtRest(RandomPosture(tree, random));
  state.velocity = random.NormalVector(state.q.size(), 1.0);
  state.acceleration = random.NormalVector(state.q.size(), 3.0);
  // Column by column, unit accelerations give M(q) and so the energy 1/2 v' M v at two instants.
  const auto energy = [&](const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
    Eigen::VectorXd momentum(q.size());
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      RobotState unit = AtRest(q);
      unit.acceleration[i] = 1.0;
      momentum[i] = v.dot(InverseDynamics(tree, inertias, unit, Vector3d::Zero()).torques);
    }
    return 0.5 * momentum.dot(v);
  };
  const double step = 1e-5;
  const auto after = [&](double t) {
    return energy(state.q + t * state.velocity + 0.5 * t * t * state.acceleration,
                  state.velocity + t * state.acceleration);
  };
  const double power =
      state.velocity.dot(InverseDynamics(tree, inertias, state, Vector3d::Zero()).torques);
  // Energies are some 100 J. Rounding of 1e-14 over the step leaves 1e-7, truncation leaves less.
  EXPECT_NEAR((after(step) - after(-step)) / (2 * step), power, 1e-5 * (1.0 + std::abs(power)));
}

}  // namespace
}  // namespace elastocal
