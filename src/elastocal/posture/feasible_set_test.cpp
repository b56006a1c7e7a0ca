// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/feasible_set.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/posture/random_posture.hpp"
#include "tests/leg_problem.hpp"

namespace elastocal {
namespace {

TEST(FeasibleSet, DerivativesOfAllConstraintsEqualDifferences) {
  LegProblem leg;
  FeasibleSet& set = leg.problem.feasible;
  Random random(3);
  constexpr double kStep = 1e-6;
  for (int posture = 0; posture < 20; ++posture) {
    Eigen::VectorXd x(4);
    for (int i = 0; i < 4; ++i) x[i] = random.Uniform(set.lower[i], set.upper[i]);
    Eigen::VectorXd value, ahead, behind;
    Eigen::MatrixXd jacobian, unused;
    EvaluateConstraints(set, x, value, jacobian);
    for (int i = 0; i < 4; ++i) {
      EvaluateConstraints(set, x + kStep * Eigen::VectorXd::Unit(4, i), ahead, unused);
      EvaluateConstraints(set, x - kStep * Eigen::VectorXd::Unit(4, i), behind, unused);
      // Values and their curvature are of order one: truncation 1e-12, rounding 1e-10.
      EXPECT_LT((jacobian.col(i) - (ahead - behind) / (2 * kStep)).cwiseAbs().maxCoeff(), 1e-8);
    }
  }
}

TEST(FeasibleSet, NamesTheLimitThatIsBrokenMost) {
  LegProblem leg;
  FeasibleSet& set = leg.problem.feasible;
  Eigen::VectorXd x = leg.motion.rest;
  EXPECT_EQ(WorstViolation(set, x).amount, 0.0);
  x[0] = 1.5;  // the cosine of the cone is 0.43 too small
  EXPECT_EQ(WorstViolation(set, x).what, "limit of hip_yaw");
  EXPECT_NEAR(WorstViolation(set, x).amount, 0.5, 1e-12);
  x = Eigen::Vector4d(0.0, 0.0, 0.0, 0.0);  // straight: the foot is at -0.9, its radius 0.07
  EXPECT_EQ(WorstViolation(set, x).what, "height of FOOT above the floor");
  EXPECT_NEAR(WorstViolation(set, x).amount, 0.07, 1e-12);
}

TEST(FeasibleSet, OrientationIsTheCosineOfTheTurn) {
  LegProblem leg;
  FeasibleSet& set = leg.problem.feasible;
  Eigen::VectorXd values;
  Eigen::MatrixXd jacobian;
  EvaluateConstraints(set, Eigen::Vector4d(0.2, 0.0, -0.5, 1.0), values, jacobian);
  // The axis turns about z before the pitch at rest, so only the yaw turns it. The first rows are
  // the box (3), then follows the cone.
  EXPECT_NEAR(values[3], std::cos(0.2), 1e-12);
}

TEST(FeasibleSampler, DrawsFeasiblePosturesAndCountsThem) {
  LegProblem leg;
  FeasibleSampler sampler(leg.problem.feasible, 1);
  for (int i = 0; i < 200; ++i) {
    const auto x = sampler.Draw();
    ASSERT_TRUE(x);
    EXPECT_EQ(WorstViolation(leg.problem.feasible, *x).amount, 0.0);
  }
  EXPECT_EQ(sampler.count().found, 200);
  EXPECT_GT(sampler.count().Yield(), 0.3);  // otherwise most of the workspace would be out of reach
  // Repair adds postures that are not feasible after the end is placed.
  EXPECT_LT(sampler.count().feasible_at_once, sampler.count().found);
}

TEST(FeasibleSampler, SameSeedSamePostures) {
  LegProblem a, b;
  FeasibleSampler first(a.problem.feasible, 7), second(b.problem.feasible, 7);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(*first.Draw(), *second.Draw());
}

// The knee cannot pass spheres beside the leg. The postures beyond them satisfy all limits.
TEST(FeasibleSampler, DrawsOnlyWhatCanBeReached) {
  constexpr double kWall = 0.5;  // rad of hip_roll
  const RobotTree tree = MakeLegRobot();
  MotionSetup motion = LegMotion(tree);
  ChainSetup setup = LegSetup(tree);
  setup.coordinates = {1, 2, 3};
  setup.box.reset();
  setup.floor_z.reset();
  setup.largest_turn = M_PI;
  for (int i = -6; i <= 6; ++i) {
    Eigen::VectorXd q = motion.rest;
    q[1] = kWall;
    q[2] = 0.2 * i;
    const int knee = FindLink(tree, "knee_link");
    const Eigen::Vector3d centre =
        LinkTransforms(tree, q)[static_cast<std::size_t>(knee)].translation();
    setup.contacts.emplace_back(1, static_cast<int>(motion.spheres.size()));
    motion.spheres.push_back({"WALL", 0, centre, 0.05});
  }
  FeasibleSet set = MakeFeasibleSet(tree, motion, setup);
  FeasibleSampler sampler(set, 1);
  for (int i = 0; i < 100; ++i) {
    const auto x = sampler.Draw();
    ASSERT_TRUE(x);
    EXPECT_LT((*x)[0], kWall);
  }
  const Eigen::Vector3d beyond(0.9, 0.0, 1.0);
  EXPECT_EQ(WorstViolation(set, beyond).amount, 1.0);
  EXPECT_EQ(
      WorstViolation(set, beyond).Describe(),
      "cannot be reached: no way from the posture of rest past the robot's own parts was found");
  EXPECT_EQ(
      WorstViolation(set, Eigen::Vector3d(0.0, 0.0, 9.0)).Describe().find("breaks the limit of"),
      0U);
  setup.contacts.resize(setup.contacts.size() - 4);  // a door at one end
  FeasibleSet open = MakeFeasibleSet(tree, motion, setup);
  EXPECT_EQ(WorstViolation(open, beyond).amount, 0.0);
}

TEST(FeasibleSampler, BlamesTheLimitThatLeavesNothing) {
  const RobotTree tree = MakeLegRobot();
  const MotionSetup motion = LegMotion(tree);
  ChainSetup setup = LegSetup(tree);
  setup.floor_z = -0.2;  // above the highest foot
  FeasibleSet set = MakeFeasibleSet(tree, motion, setup);
  FeasibleSampler sampler(set, 1);
  EXPECT_FALSE(sampler.Draw(100));
  EXPECT_NE(sampler.Blame().find("above the floor"), std::string::npos) << sampler.Blame();
}

}  // namespace
}  // namespace elastocal
